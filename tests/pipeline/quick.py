"""The small studies that tests make variants of: small flat pictures, hashes for vectors, fifty texts as baseline."""

from pathlib import Path

from filelock import FileLock

from oodscen import Study, StudyConfig
from oodscen._pipeline import run_study
from oodscen.data._episode import Episode
from oodscen.judging._selection import choose_items

ORDINARY = Path(__file__).with_name("ordinary.txt")
QUICK = StudyConfig.quick(
    simulator="flat",
    encoder="hash",
    baseline=str(ORDINARY),
    iterations=4,
    max_paths=2,
    seed=3,
    width=160,
    height=120,
)
SMALL = QUICK.model_copy(update={"max_paths": 1, "iterations": 2})
"""One scene of the quick study, for what needs no second one."""


def finished(config: StudyConfig, folder: Path) -> Path:
    """Return a folder with the finished study, which the first process that asks for it runs."""
    with FileLock(f"{folder}.lock"):
        if not folder.exists():
            part = folder.with_name(f"{folder.name}.part")
            run_study(part, config)
            part.rename(folder)
    return folder


def asked_about(study: Study) -> list[Episode]:
    """Return the episodes that answerers are asked about: every scene with one of its ordinary drives."""
    return choose_items(study.episodes, count=study.config.ordinary, seed=study.config.seed)
