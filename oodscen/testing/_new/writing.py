"""Writing a new adapter's package from the files of this folder."""

import keyword
import re
from collections.abc import Mapping
from pathlib import Path
from shutil import rmtree

from oodscen._entry_points import names
from oodscen._io.files import bundled, check_name, writing
from oodscen.errors import UsageError

_NAME = re.compile(r"(?=.{1,41}$)[a-z][a-z0-9]*(_+[a-z0-9]+)*")
_FILES = {
    "README.md": "README.md",
    "pyproject.toml": "pyproject.toml",
    "adapter.py": "{package}/__init__.py",
    "test_adapter.py.txt": "tests/test_{name}.py",
}
"""The path in the written package of each file of this folder."""


def write_adapter(name: str, folder: str | Path = ".") -> tuple[Path, ...]:
    """Write a package with an adapter that passes the conformance check, and its tests.

    Args:
        name: The simulator's name, in lower case with underscores; the package is `oodscen_NAME`.
        folder: The folder in which the package's folder is made.

    Returns:
        The written files.

    Raises:
        UsageError: If `name` is not a lower-case identifier, is taken, or the package's folder exists.
        OodscenError: If the files cannot be written; what was begun is removed.
    """
    if not _NAME.fullmatch(name) or keyword.iskeyword(name):
        raise UsageError(
            f"{name[:60]!r} cannot be the name of a simulator: use at most 41 small letters, digits and "
            "underscores that begin with a letter and do not end with an underscore, and no word of Python, e.g. "
            "my_simulator"
        )
    if name in names("simulator"):
        raise UsageError(f"a simulator called {name!r} is installed already; choose another name")
    package = f"oodscen_{name}"
    target = Path(folder) / package
    check_name(target)
    camel_case = "".join(part.capitalize() for part in name.split("_"))
    replacements = {
        "MySimulator": camel_case.removesuffix("Simulator") + "Simulator",
        "my_simulator": name,
        "my_package": package,
        "my-package": package.replace("_", "-"),
    }
    with writing(target):
        try:
            target.mkdir(parents=True)
        except FileExistsError as error:
            raise UsageError(f"{target} exists already") from error
        try:
            return tuple(
                _write_file(target / path.format(package=package, name=name), source, replacements)
                for source, path in _FILES.items()
            )
        except BaseException:
            rmtree(target, ignore_errors=True)
            raise


def _write_file(path: Path, source: str, replacements: Mapping[str, str]) -> Path:
    """Write a copy of a file of this folder in which the example's names are replaced."""
    text = bundled(source, "oodscen.testing._new")
    names_of_example = "|".join(map(re.escape, replacements))
    text = re.sub(names_of_example, lambda match: replacements[match[0]], text)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path
