"""The tables of docs/interchange.md."""

import re
from pathlib import Path

_PAGE = (Path(__file__).parents[2] / "docs" / "interchange.md").read_text("utf-8")


def table(name: str) -> list[list[str]]:
    """Return the cells of a table's rows, without code marks; `–` is an empty cell."""
    found = re.search(rf"<!-- {name} -->\n(.*?)<!-- end -->", _PAGE, re.DOTALL)
    assert found, name
    rows = [line.strip("| ").split(" | ") for line in found[1].splitlines()[2:]]
    return [["" if cell == "–" else cell.strip("`") for cell in row] for row in rows]
