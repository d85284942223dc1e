"""Writing a study as a data set, whole and with its card."""

import re
from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

from oodscen._arguments import checked, refuse_key
from oodscen._io.files import check_name, file_sha256, writing
from oodscen._io.study_files import refuse_inside
from oodscen._numbers import finite_number
from oodscen.errors import DataError, Issue, StudyError, UsageError
from oodscen.publish._card import card
from oodscen.publish._drivelm import write_drivelm
from oodscen.publish._lmms_eval.tasks import write_tasks
from oodscen.publish._parquet import write_drives, write_questions
from oodscen.publish._question_rows import PublishedDrive, labels_of_leaves, published_drives
from oodscen.publish._replacing import CARD, SUMS, names, replacing
from oodscen.publish._splits import SPLITS, VALIDATION, splits
from oodscen.publish._vlmevalkit import write_tsv
from oodscen.study._asked import asked_drives
from oodscen.study._study import Study

Form = Literal["vlmevalkit", "lmms-eval", "drivelm"]
FORMS: tuple[Form, ...] = get_args(Form)
"""Forms for other tools beside the Parquet files."""

LICENCE = "cc-by-4.0"
_LICENCE = re.compile(
    r"(?!(?i:yes|no?|y|true|false|on|off|null|[\d.+-]+(e\d+)?)$)[A-Za-z0-9][A-Za-z0-9.+-]{0,60}"
)
"""Matches identifiers of licences that the card's YAML reads as texts."""


@dataclass(frozen=True)
class Publication:
    """The result of publishing a study."""

    folder: Path
    files: dict[str, int]
    """Size of every file in bytes, by name."""
    drives: dict[str, int]
    """Number of drives by split."""
    questions: int

    def __str__(self) -> str:
        size = sum(self.files.values()) / 1e6
        splits = ", ".join(f"{count} in {split}" for split, count in self.drives.items())
        return (
            f"{self.folder}: {self.questions} questions about {sum(self.drives.values())} drives "
            f"({splits}), {len(self.files)} files, {size:.1f} MB"
        )


@checked
def publish(
    study: Study,
    out: str | Path,
    *,
    forms: Collection[Form] = FORMS,
    validation: float = VALIDATION,
    licence: str = LICENCE,
) -> Publication:
    """Write a study as a data set; `Study.publish` tells arguments and errors."""
    finite_number("validation", validation, 0.0, 0.9)
    check_name(out)
    refuse_key("licence", licence)
    if not _LICENCE.fullmatch(licence):
        raise UsageError(f"licence: {licence!r} is not an identifier such as {LICENCE}")
    folder = Path(out)
    refuse_inside(folder)
    asked = asked_drives(study)
    board = study.leaderboard() if study.store.has("verdicts.jsonl") else None
    split_of_leaf = splits(labels_of_leaves(asked), share=validation, seed=study.config.seed)
    drives = published_drives(asked, split_of_leaf)
    if not drives:
        raise DataError("study", [Issue("", "no scene has frames")], source=str(study.folder))
    with writing(folder, StudyError), replacing(folder) as part:
        questions = _write(part, study, drives, forms)
        hashes = {name: file_sha256(part / name).hex() for name in names(part)}
        readme = part / CARD
        readme.write_text(card(study, board, drives, licence, hashes), encoding="utf-8")
        hashes[readme.name] = file_sha256(readme).hex()
        sums = "".join(f"{hashes[name]}  {name}\n" for name in sorted(hashes))
        (part / SUMS).write_text(sums, encoding="utf-8")
    files = {name: (folder / name).stat().st_size for name in names(folder)}
    return Publication(folder, files, dict(Counter(drive.split for drive in drives)), questions)


def _write(
    folder: Path, study: Study, drives: list[PublishedDrive], forms: Collection[Form]
) -> int:
    demands = {scene.id: scene for scene in study.demands}
    questions, files = 0, []
    for split in SPLITS:
        part = [drive for drive in drives if drive.split == split]
        if part:
            name = f"data/questions/{split}.parquet"
            files.append((split, f"../../{name}"))
            questions += write_questions(folder / name, part)
            write_drives(folder / f"data/drives/{split}.parquet", part, demands)
    if "vlmevalkit" in forms:
        write_tsv(folder / "vlmevalkit" / "oodscen.tsv", drives)
    if "lmms-eval" in forms:
        write_tasks(folder / "lmms_eval" / "oodscen", files)
    if "drivelm" in forms:
        write_drivelm(folder / "drivelm", drives)
    return questions
