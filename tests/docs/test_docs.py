"""Every Python block of README and docs runs, file by file, in order; so does every example and notebook."""

import ast
import json
import re
import runpy
import shutil
from pathlib import Path

import pytest

from oodscen import StudyConfig
from oodscen._cli import EXIT_CODES
from oodscen._pipeline import run_study
from oodscen.baselines._baseline import Baseline
from tests.pipeline.quick import ORDINARY

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))
ARGUMENTS = {"learning_to_stop": ["250"], "made_scenes": ["made", "flat"]}
"""Arguments with which an example takes less time."""
BLOCK = re.compile(r"^```python\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.fixture(scope="module", autouse=True)
def _small_studies():
    """Have fifty ordinary texts where thousands would be encoded, and small pictures in quick studies."""
    few = Baseline(texts=tuple(ORDINARY.read_text("utf-8").splitlines()))
    smaller = {"width": 160, "height": 120, "demands": False}
    quick = StudyConfig.quick
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(StudyConfig, "quick", lambda **changes: quick(**smaller | changes))
        for user in ("_metrics", "_vectors.space", "_detection.guard"):
            patch.setattr(f"oodscen.metrics.{user}.ordinary_driving", lambda: few)
        yield


@pytest.fixture(scope="module")
def study(_small_studies, tmp_path_factory):
    """Make the study that pages about reading one expect in `out`."""
    folder = tmp_path_factory.mktemp("docs") / "out"
    run_study(folder, StudyConfig.quick(simulator="flat", encoder="hash"))
    return folder


@pytest.fixture
def workplace(tmp_path, monkeypatch, study, minilm):
    """Be in a folder with the study `out`."""
    (tmp_path / "out").symlink_to(study)
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.stem)
def test_the_code_of_a_page_runs(page, workplace, capsys):
    if page.stem == "gymnasium":
        pytest.importorskip("gymnasium")
    text = page.read_text(encoding="utf-8")
    names = {"__name__": "__main__"}
    for match in BLOCK.finditer(text):
        line = text[: match.start(1)].count("\n")
        exec(compile("\n" * line + match.group(1), str(page), "exec"), names)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(example, workplace, capsys, monkeypatch):
    monkeypatch.setattr("sys.argv", [str(example), *ARGUMENTS.get(example.stem, ())])
    runpy.run_path(str(example), run_name="__main__")
    assert capsys.readouterr().out.strip()


@pytest.mark.parametrize(
    ("example", "arguments", "said"),
    [
        ("made_scenes", ["out", "flat"], "out is not empty"),
        ("made_scenes", ["file", "flat"], "file is not empty"),
        ("made_scenes", ["new", "nothing"], "nothing"),
        ("contact_sheet", ["nothing"], "nothing"),
        ("contact_sheet", ["out", "nowhere/sheet.jpg"], "nowhere/sheet.jpg cannot be written"),
        ("contact_sheet", ["out", "sheet.what"], "suffix"),
        (
            "contact_sheet",
            ["out", "sheet.jpg", "later"],
            "no frame of 'later' in out; it has first",
        ),
        ("quickstart", ["nothing"], "nothing"),
    ],
)
def test_an_example_says_what_is_wrong_and_writes_nothing(
    example, arguments, said, workplace, study, monkeypatch
):
    Path("file").touch()
    before = {path: path.read_bytes() for path in study.rglob("*") if path.is_file()}
    listed = {*Path().iterdir()}
    path = ROOT / "examples" / f"{example}.py"
    monkeypatch.setattr("sys.argv", [str(path), *arguments])
    with pytest.raises(SystemExit) as stopped:
        runpy.run_path(str(path), run_name="__main__")
    assert str(stopped.value).startswith(f"{example}: ")
    assert said in str(stopped.value)
    assert {path: path.read_bytes() for path in study.rglob("*") if path.is_file()} == before
    assert {*Path().iterdir()} == listed


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(notebook, study, minilm, tmp_path, monkeypatch, capsys):
    shutil.copytree(study, tmp_path / "out")
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "__main__"}
    for cell in cells(notebook):
        tree = ast.parse("".join(cell["source"]))
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, notebook.name, "exec"), names)
        if last is not None:
            shown = eval(compile(ast.Expression(last.value), notebook.name, "eval"), names)
            getattr(shown, "_repr_html_", str)()


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_shipped_with_its_outputs_and_small(notebook):
    assert [cell["execution_count"] for cell in cells(notebook)] == [
        number for number, _ in enumerate(cells(notebook), 1)
    ]
    outputs = [output for cell in cells(notebook) for output in cell["outputs"]]
    assert outputs
    assert all(output["output_type"] != "error" for output in outputs)
    assert notebook.stat().st_size < 200_000


def cells(notebook):
    """Return the code cells of a notebook."""
    read = json.loads(notebook.read_text(encoding="utf-8"))
    return [cell for cell in read["cells"] if cell["cell_type"] == "code"]


def test_links_lead_somewhere():
    for page in PAGES:
        for target in re.findall(r"\]\((?!https?://)([^)#]+)", page.read_text(encoding="utf-8")):
            assert (page.parent / target).exists(), f"{page.name}: {target}"


def test_files_of_the_house_that_pages_and_benchmarks_name_exist():
    """A path in a page begins anywhere in the house: `_roads/`, `data/`, `oodscen/`."""
    folders = ("oodscen", "adapters", "tests", "tools", "benchmarks", "examples", "docs")
    house = [
        f"/{path.relative_to(ROOT)}" for name in folders for path in (ROOT / name).rglob("*.*")
    ]
    named = {
        (page.name, path)
        for page in [*PAGES, *(ROOT / "benchmarks").glob("*.py")]
        for path in re.findall(
            r"[`\"]((?:[\w.-]+/)+\w+\.(?:py|toml|md))[`\"]", page.read_text("utf-8")
        )
    }
    assert len(named) > 90
    lost = {(page, path) for page, path in named if not any(f.endswith(f"/{path}") for f in house)}
    assert not lost


def test_the_page_of_the_command_line_has_the_exit_codes():
    page = (ROOT / "docs" / "command_line.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (\d+) \| (.+) \|$", page, re.MULTILINE)
    assert {int(code): meaning for code, meaning in rows} == EXIT_CODES
