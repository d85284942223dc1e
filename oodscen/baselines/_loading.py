"""Reading of a baseline: the bundled one, a user's file, or a public driving data set."""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

from oodscen._arguments import checked
from oodscen._io.files import read_utf8
from oodscen.baselines._baseline import Baseline
from oodscen.baselines._dataset_texts import TextsAndIssues
from oodscen.baselines._datasets import (
    FileLayout,
    LayoutName,
    chosen_parts,
    layout_of,
    read_as,
    recognise,
)
from oodscen.baselines._handwritten import handwritten_driving
from oodscen.baselines._ordinary import ordinary_driving
from oodscen.baselines._reading import read_records
from oodscen.baselines._texts import refuse
from oodscen.errors import Issue, UsageError


@checked
def load_baseline(
    path: str | Path | None = None,
    *,
    layout: LayoutName | Literal["auto", "plain"] = "auto",
    parts: Sequence[str] | None = None,
    distinct: bool = False,
    name: str = "",
    licence: str = "",
) -> Baseline:
    """Read a baseline from a file of your own, or from one of a public driving data set.

    Without a path it is the bundled one. Your own files (`plain`): lines, JSON lines with `text`, a JSON list, or
    CSV or TSV with a column `text`. Data sets, as they are distributed: DriveLM, nuScenes, Talk2Car, BDD-X and
    CityFlow-NL; see `oodscen.baselines._datasets` for their files, texts and licences.

    Equal texts are kept unless `distinct`: a text that occurs often is as ordinary as one that
    occurs once, and `tabulated` OOD-ness does not change. Random draws from the baseline do change.

    Args:
        path: The file; the bundled texts of ordinary driving if left out.
        layout: The file's layout; `auto` detects it from the content, `plain` is a file of your own.
        parts: The texts of a data set to read, e.g. `["scene"]` for the scene descriptions of
            DriveLM; by default those that `oodscen.baselines._datasets` lists first. Of the bundled
            texts, `["handwritten"]` are those that were written by hand.
        distinct: Keep only the first of equal texts.
        name: The name shown in reports; the file's name by default.
        licence: Licence for redistribution of the texts; that of the data set by default.

    Raises:
        DataError: If the file cannot be read, is not UTF-8, holds no text, or does not match its
            layout: one issue per place.
        UsageError: If there is no such layout or part.
    """
    if path is None:
        if layout not in ("auto", "plain"):
            raise UsageError(f"layout {layout!r} is that of a file: give its path")
        return _bundled(parts)
    file = Path(path)
    recognised = _dataset(file, layout)
    if recognised is not None:
        dataset, items = recognised
        texts = _dataset_texts(dataset, items, parts, str(path))
        source = f"{dataset.title}, {file.name}"
        licence = licence or dataset.licence
    elif parts is not None:
        raise UsageError(f"{file.name} is a plain file of texts, and has no parts")
    else:
        texts = [record.text for record in read_records(path, Baseline.noun)]
        source = file.name
    return Baseline(
        texts=tuple(dict.fromkeys(texts) if distinct else texts),
        name=name or file.name,
        source=source,
        licence=licence,
    )


def _bundled(parts: Sequence[str] | None) -> Baseline:
    if parts is None:
        return ordinary_driving()
    if tuple(parts) == ("handwritten",):
        return handwritten_driving()
    raise UsageError("the only part of the bundled baseline is `handwritten`")


def _dataset(file: Path, layout: str) -> tuple[FileLayout, TextsAndIssues] | None:
    """Return the layout of a data set's file, and its texts."""
    if layout == "plain":
        return None
    if layout == "auto":
        return recognise(read_utf8(file, Baseline.noun), file.suffix.lower())
    dataset = layout_of(layout)
    return dataset, read_as(dataset, read_utf8(file, Baseline.noun))


def _dataset_texts(
    layout: FileLayout, items: TextsAndIssues, parts: Sequence[str] | None, source: str
) -> list[str]:
    kinds = layout.default_parts if parts is None else chosen_parts(layout, tuple(parts))
    issues: list[Issue] = []
    texts: list[str] = []
    for item in items:
        if isinstance(item, Issue):
            issues.append(item)
        elif item.kind in kinds:
            texts.append(item.text)
    if not texts and not issues:
        issues.append(Issue("", f"holds none of these texts of {layout.title}: {', '.join(kinds)}"))
    refuse(Baseline.noun, issues, source=source)
    return texts
