"""The card of a data set: what is in it, how it was made, and how it may be used."""

import html
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import jinja2

from oodscen._version import __version__
from oodscen._words.text import one_line, printable
from oodscen.data._base import canonical_json
from oodscen.data._reactions import drivers_in_words
from oodscen.judging._kinds import merge_kinds
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.requirements import FIGURES
from oodscen.judging._leaderboard.rows import Rate
from oodscen.judging._people import person
from oodscen.publish._question_rows import (
    TASKS,
    PublishedDrive,
    labels_of_leaves,
    question_rows,
)
from oodscen.publish._splits import SPLITS
from oodscen.study._study import Study

_PRIVATE = {"api_base", "baseline", "people", "servers"}
"""Fields of the configuration that name people, servers and files of the one who publishes."""

_MAX_ROWS = 24
"""Maximum number of rows of figures in a card: judged models come first."""
_SIZES = ((10**3, "n<1K"), (10**4, "1K<n<10K"), (10**5, "10K<n<100K"), (10**6, "100K<n<1M"))
"""Size categories of the Hub by the number of rows below which they hold."""


def card(
    study: Study,
    board: Leaderboard | None,
    drives: Sequence[PublishedDrive],
    licence: str,
    hashes: Mapping[str, str],
) -> str:
    """Return the card as Markdown with the front matter that the Hub reads.

    `board` is the study's leaderboard, if models were judged; `licence` is a name that the Hub knows, and `hashes`
    the SHA-256 of the files by name.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("oodscen", "publish"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["cell"] = _cell
    return environment.get_template("card.md.j2").render(
        licence=licence,
        version=__version__,
        info=study.info,
        config=study.config,
        configuration=_without_folders(
            canonical_json(study.config.model_dump(mode="json", exclude=_PRIVATE))
        ),
        splits=_splits(drives),
        figures=FIGURES,
        rows=_rows(board),
        drivers=drivers_in_words(
            set(study.config.reaction), rehearses=study.info.get("rehearses", True)
        ),
        judge=board.judge.rpartition("@")[0] if board else "",
        tasks=TASKS,
        unanswerable=sum(row.best is None for drive in drives for row in question_rows(drive)),
        size=_size(len(drives) * len(TASKS)),
        hashes=[(name, digest) for name, digest in hashes.items() if "/images/" not in name],
    )


def _without_folders(text: str) -> str:
    """Return a text in which the files of models, as in `builtin:FILE`, are named without their folders."""
    return re.sub(r"\b(builtin|replay):[^\s\"]*/", r"\1:", text)


def _cell(value: object) -> str:
    """Return a text on one line without markup: no HTML, links, code or columns."""
    text = html.escape(one_line(printable(_without_folders(str(value)))), quote=False)
    return re.sub(r"[\\`\[\]|]", r"\\\g<0>", text)


def _splits(drives: Sequence[PublishedDrive]) -> list[dict[str, Any]]:
    """Return the numbers and kinds of the splits that have drives."""
    drives_by_split = {name: [drive for drive in drives if drive.split == name] for name in SPLITS}
    return [_split(name, within) for name, within in drives_by_split.items() if within]


def _split(name: str, drives: Sequence[PublishedDrive]) -> dict[str, Any]:
    counts = Counter(drive.kind for drive in drives)
    kinds = merge_kinds(labels_of_leaves(drive.asked for drive in drives))
    return {
        "name": name,
        "drives": len(drives),
        "questions": len(drives) * len(TASKS),
        "kinds": sorted(kind.label for kind in kinds),
        **{kind: counts[kind] for kind in ("rare", "twin", "demand")},
    }


def _rows(board: Leaderboard | None) -> list[dict[str, Any]]:
    """Return the figures of judged models and references, by the names of requirements."""
    if board is None:
        return []
    rows = sorted(board.standings, key=lambda row: row.protocol == "paper")
    return [
        {
            "model": "a person" if row.model.startswith(person("")) else row.model,
            "kind": row.kind,
            "protocol": row.protocol,
            "notice-both": _share(row.paired.notice),
            "act-both": _share(row.paired.act),
            "notice": _share(row.detection.sensitivity),
            "alarms": _share(row.detection.alarms),
            "name": _share(row.identification.open),
            "pick": _share(row.identification.closed),
            "safe": _share(row.control.safe),
            "needless": _share(row.control.needless),
        }
        for row in rows[:_MAX_ROWS]
    ]


def _share(rate: Rate) -> str:
    if rate.value is None:
        return "–"
    share = f"{100 * rate.value:.1f} %"
    if rate.interval is None:
        return share
    return f"{share} ({100 * rate.interval.low:.0f}–{100 * rate.interval.high:.0f})"


def _size(questions: int) -> str:
    """Return the size category of the Hub."""
    return next((name for limit, name in _SIZES if questions < limit), "1M<n<10M")
