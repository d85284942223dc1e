"""Names that are imported late are those that type checkers see."""

import ast
from importlib import import_module
from pathlib import Path

import pytest


@pytest.mark.parametrize("name", ["oodscen", "oodscen.claims", "oodscen.testing", "oodscen.trees"])
def test_every_name_comes_from_where_type_checkers_find_it(name):
    package = import_module(name)
    tree = ast.parse(Path(package.__file__).read_text(encoding="utf-8"))
    seen = [one for one in ast.walk(tree) if isinstance(one, ast.ImportFrom)]
    homes = {
        alias.name: one.module
        for one in seen
        for alias in one.names
        if one.module.startswith("oodscen.") and alias.name != "lazily"
    }
    assert sorted(homes) == dir(package) == sorted(package.__all__)
    for one, home in homes.items():
        assert getattr(package, one) is getattr(import_module(home), one)
    with pytest.raises(AttributeError, match="nonsense"):
        package.nonsense  # noqa: B018
