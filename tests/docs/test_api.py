"""The page of public names lists what the packages list, and docs and examples use nothing else."""

import ast
import importlib
import json
import pkgutil
import re
from pathlib import Path

import pytest

import oodscen

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "api.md").read_text(encoding="utf-8")
LISTED = {
    name: set(re.findall(r"`(\w+)`", listing))
    for name, listing in re.findall(r"^## `([\w.]+)`\n\n[^\n]*\n\n([^\n]*)$", PAGE, re.MULTILINE)
}
UNLISTED = {
    f"oodscen.{name}"
    for name in (
        "claims",
        "encoders",
        "inspect",
        "metrics",
        "numerics",
        "stages",
        "statistics",
        "study",
        "tree",
    )
}
"""Packages that list no name."""
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)
TEXTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
EXAMPLES = [
    *sorted((ROOT / "examples").glob("*.py")),
    *sorted((ROOT / "examples" / "notebooks").glob("*.ipynb")),
]


def test_every_public_package_has_its_section():
    found = {
        f"oodscen.{module.name}"
        for module in pkgutil.iter_modules(oodscen.__path__)
        if not module.name.startswith("_")
    }
    assert {*LISTED, *UNLISTED} == {"oodscen", *found}
    assert not any(getattr(importlib.import_module(name), "__all__", ()) for name in UNLISTED)


@pytest.mark.parametrize("name", LISTED)
def test_a_package_lists_its_names_and_has_them(name):
    if name == "oodscen.gymnasium":
        pytest.importorskip("gymnasium")
    package = importlib.import_module(name)
    assert LISTED[name] == set(package.__all__)
    assert all(hasattr(package, listed) for listed in LISTED[name])


def test_the_page_counts_its_names():
    counted = set().union(*(names for name, names in LISTED.items() if name != "oodscen.errors"))
    assert f"\n{len(counted - LISTED['oodscen.errors'])} names," in PAGE


@pytest.mark.parametrize("path", [*TEXTS, *EXAMPLES], ids=lambda path: path.name)
def test_docs_and_examples_import_public_names_only(path):
    text = path.read_text(encoding="utf-8")
    blocks = BLOCK.findall(text) if path.suffix == ".md" else [text]
    if path.suffix == ".ipynb":
        cells = json.loads(text)["cells"]
        blocks = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    for block in blocks:
        code = re.sub(r"^\s*[%!].*$", "", block, flags=re.MULTILINE)
        for node in ast.walk(ast.parse(code)):
            if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("oodscen"):
                known = LISTED.get(node.module or "", set())
                private = {alias.name for alias in node.names} - known
                assert not private, f"{node.module}: {private}"
            elif isinstance(node, ast.Import):
                names = {alias.name for alias in node.names if alias.name.startswith("oodscen")}
                assert names <= set(LISTED), names
