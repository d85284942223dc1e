"""The written package passes its own tests, and its simulator the quick check."""

import ast
import os
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner

from oodscen._cli import main
from oodscen.errors import UsageError
from oodscen.testing import check_simulator
from oodscen.testing._new.adapter import MySimulator
from oodscen.testing._new.writing import write_adapter


def test_the_example_keeps_the_protocol() -> None:
    check_simulator(MySimulator, resets=20, parts=("appearance", "motion", "measures", "pictures"))


def test_the_written_package_passes_its_tests(tmp_path) -> None:
    written = write_adapter("road_runner2", tmp_path)
    folder = tmp_path / "oodscen_road_runner2"
    assert all(path.is_relative_to(folder) for path in written)
    for path in written:
        text = path.read_text("utf-8")
        assert "my_" not in text.lower()
        assert "mysim" not in text.lower()
    code = (folder / "oodscen_road_runner2" / "__init__.py").read_text("utf-8")
    assert "class RoadRunner2Simulator(RestorableSimulator)" in code
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-n", "0"],
        cwd=folder,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        timeout=300,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-500:]


def test_the_adapter_is_short() -> None:
    source = sys.modules[MySimulator.__module__].__file__ or ""
    with open(source, encoding="utf-8") as file:
        text = file.read()
    ast.parse(text)
    lines = [
        line for line in text.splitlines() if line.strip() and not line.strip().startswith("#")
    ]
    assert len(lines) < 200


@pytest.mark.parametrize(
    "name",
    ["", "A", "1a", "a-b", "../a", "class", "a" * 42, "a\n", "a\nb", "ä", "flat", "_a", "a_"],
)
def test_strange_names_are_refused(name, tmp_path) -> None:
    with pytest.raises(UsageError):
        write_adapter(name, tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["my_package", "my_simulator", "a__b", "a" * 41])
def test_every_name_is_that_of_the_simulator(name, tmp_path) -> None:
    write_adapter(name, tmp_path)
    project = (tmp_path / f"oodscen_{name}" / "pyproject.toml").read_text("utf-8")
    ((entry, path),) = tomllib.loads(project)["project"]["entry-points"][
        "oodscen.simulators"
    ].items()
    assert entry == name
    package, _, simulator = path.partition(":")
    assert package == f"oodscen_{name}"
    code = (tmp_path / package / package / "__init__.py").read_text("utf-8")
    assert f"class {simulator}(" in code
    assert f'name = "{name}"' in code


def test_nothing_is_overwritten(tmp_path) -> None:
    write_adapter("mine", tmp_path)
    with pytest.raises(UsageError, match="exists already"):
        write_adapter("mine", tmp_path)


def test_the_documentation_shows_the_adapter_that_is_written() -> None:
    page = (Path(__file__).parents[3] / "docs" / "adapters.md").read_text("utf-8")
    source = Path(sys.modules[MySimulator.__module__].__file__ or "").read_text("utf-8")
    assert f"```python\n{source}```\n" in page


def test_a_package_that_cannot_be_written_whole_is_not_left_half(tmp_path, monkeypatch):
    writes, write = iter(range(2)), Path.write_text

    def full(path, *given, **named):
        if next(writes, None) is None:
            raise OSError(28, "No space left on device")
        return write(path, *given, **named)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_text", full)
        done = CliRunner().invoke(main, ["new", "adapter", "mine", "--into", str(tmp_path)])
    assert (done.exit_code, done.stdout) == (1, "")  # As of every file that cannot be written.
    assert "cannot write" in done.stderr
    assert "No space left" in done.stderr
    assert list(tmp_path.iterdir()) == []
    assert write_adapter("mine", tmp_path)
