"""The YAML files of the tasks for lmms-eval."""

from collections.abc import Collection
from importlib import resources
from pathlib import Path

from oodscen.judging._leaderboard.figures import FAULTS
from oodscen.publish._answers import FIGURES_OF_TASK
from oodscen.publish._question_rows import TASKS

_COMMON = """\
dataset_path: parquet
dataset_kwargs:
  data_files:
{files}
test_split: test
output_type: generate_until
doc_to_visual: !function utils.doc_to_visual
doc_to_text: !function utils.doc_to_text
doc_to_target: answer
process_results: !function utils.process_results
generation_kwargs:
  until: []
  max_new_tokens: 1024
  temperature: 0
  do_sample: false
metadata:
  version: 1.0
"""


def write_tasks(folder: Path, files: Collection[tuple[str, str]]) -> None:
    """Write the task folder; `files` holds the file of every split, relative to the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    lines = "\n".join(f"    {split}: {file}" for split, file in files)
    _write(folder / "_common.yaml", _COMMON.format(files=lines))
    names = []
    for tasks in TASKS.values():
        figures = [figure for task in tasks for figure in FIGURES_OF_TASK[task]]
        metrics = "".join(
            f"  - metric: {figure}\n"
            f"    aggregation: !function utils.{figure.replace('-', '_')}\n"
            f"    higher_is_better: {str(figure not in FAULTS).lower()}\n"
            for figure in figures
        )
        name = f"oodscen_{tasks[0]}"
        names.append(name)
        _write(
            folder / f"{name}.yaml",
            f"include: _common.yaml\ntask: {name}\n"
            f"process_docs: !function utils.{tasks[0]}_docs\nmetric_list:\n{metrics}",
        )
    members = "".join(f"  - {name}\n" for name in names)
    _write(folder / "oodscen.yaml", f"group: oodscen\ntask:\n{members}")
    source = resources.files("oodscen.publish._lmms_eval").joinpath("utils.py")
    _write(folder / "utils.py", source.read_text(encoding="utf-8"))


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
