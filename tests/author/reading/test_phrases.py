import re
import tomllib
from importlib import resources
from pathlib import Path

import oodscen.author
from oodscen.author._reading import phrases

TABLE = tomllib.loads(
    resources.files("oodscen.author._reading").joinpath("phrases.toml").read_text("utf-8")
)
SOURCES = "".join(
    path.read_text("utf-8") for path in Path(oodscen.author.__path__[0]).rglob("*.py")
)


def test_the_rows_of_the_table_are_the_ones_that_readers_ask_for() -> None:
    for name, get in (("context", phrases.context), ("things", phrases.things)):
        asked = set(re.findall(rf'phrases\.{name}\("(\w+)"\)', SOURCES))
        assert asked == set(TABLE[name])
        assert all(map(get, TABLE[name]))
    asked = set(re.findall(r'phrases\.statements\("(\w+)"\)', SOURCES))
    assert asked == {row["about"] for row in TABLE["statement"]}
    assert all(map(phrases.statements, asked))
