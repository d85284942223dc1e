"""The page of public names lists what the packages list, and nothing public is left out."""

import importlib
import pkgutil
import re
from pathlib import Path

import pytest

import oodscen

PAGE = (Path(__file__).parents[2] / "docs" / "api.md").read_text(encoding="utf-8")
LISTED = {
    name: set(re.findall(r"`(\w+)`", listing))
    for name, listing in re.findall(r"^## `([\w.]+)`\n\n[^\n]*\n\n([^\n]*)$", PAGE, re.MULTILINE)
}
MODULES = ("oodscen.errors", "oodscen.protocols")
"""Modules of one file, whose public names are those that they define."""


def test_every_public_package_has_its_section():
    found = {
        f"oodscen.{module.name}"
        for module in pkgutil.iter_modules(oodscen.__path__)
        if not module.name.startswith("_")
    }
    assert {*LISTED, "oodscen.numerics"} == {"oodscen", *found}


@pytest.mark.parametrize("name", [name for name in LISTED if name not in MODULES])
def test_a_package_lists_its_names_and_has_them(name):
    package = importlib.import_module(name)
    assert LISTED[name] == set(package.__all__)
    assert all(hasattr(package, listed) for listed in LISTED[name])


@pytest.mark.parametrize("name", MODULES)
def test_a_module_has_the_names_that_are_listed(name):
    module = importlib.import_module(name)
    assert all(hasattr(module, listed) for listed in LISTED[name])
