"""The card of a data set: what is in it, how it was made, and how it may be used."""

import html
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import jinja2

from oodscen._text import one_line, printable
from oodscen._version import __version__
from oodscen.data._base import canonical_json
from oodscen.judging._kinds import merge_kinds
from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._leaderboard.requirements import FIGURES
from oodscen.judging._leaderboard.rows import Rate
from oodscen.judging._people import person
from oodscen.publish._question_rows import TASKS, PublishedDrive, question_rows
from oodscen.publish._splits import SPLITS
from oodscen.study._study import Study

_PRIVATE = {"api_base", "baseline", "people", "servers"}
"""Fields of the configuration that name people, servers and files of the one who publishes."""

_LISTED = 24
"""Rows of figures in a card: judged models first."""


def card(
    study: Study,
    board: Leaderboard | None,
    drives: Sequence[PublishedDrive],
    licence: str,
    hashes: Mapping[str, str],
) -> str:
    """Return the card as Markdown with the front matter that the Hub reads.

    `board` is the study's leaderboard, if models were judged; `licence` is a name that the Hub knows, `hashes` the SHA-256 of the files by name.
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
        configuration=canonical_json(study.config.model_dump(mode="json", exclude=_PRIVATE)),
        splits=[_split(name, drives) for name in SPLITS if any(d.split == name for d in drives)],
        figures=FIGURES,
        rows=_rows(board),
        tasks=TASKS,
        unanswerable=sum(row.best is None for drive in drives for row in question_rows(drive)),
        size=_size(len(drives) * len(TASKS)),
        hashes=[(name, found) for name, found in hashes.items() if "/images/" not in name],
    )


def _cell(value: object) -> str:
    """Return a text on one line without markup: no HTML, links, code or columns."""
    said = html.escape(one_line(printable(str(value))), quote=False)
    return re.sub(r"[\\`\[\]|]", r"\\\g<0>", said)


def _split(name: str, drives: Sequence[PublishedDrive]) -> dict[str, Any]:
    own = [drive for drive in drives if drive.split == name]
    labels = {
        published_drive.asked.truth.leaf: published_drive.asked.truth.path[-1]
        for published_drive in own
        if published_drive.asked.truth.path
    }
    count = Counter(drive.kind for drive in own)
    return {
        "name": name,
        "drives": len(own),
        "questions": len(own) * len(TASKS),
        "kinds": sorted(option.label for option in merge_kinds(labels)),
        **{kind: count[kind] for kind in ("rare", "twin", "demand")},
    }


def _rows(board: Leaderboard | None) -> list[dict[str, Any]]:
    """Return the figures of judged models and references, by the names of requirements."""
    own = [row for row in (board.standings if board else ()) if row.protocol == "ours"]
    return [
        {
            "model": "a person" if row.model.startswith(person("")) else row.model,
            "kind": row.kind,
            "notice-both": _share(row.paired.notice),
            "act-both": _share(row.paired.act),
            "notice": _share(row.detection.sensitivity),
            "alarms": _share(row.detection.alarms),
            "name": _share(row.identification.open),
            "pick": _share(row.identification.closed),
            "safe": _share(row.control.safe),
            "needless": _share(row.control.needless),
        }
        for row in own[:_LISTED]
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
    for most, name in ((1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K")):
        if questions < most:
            return name
    return "100K<n<1M"
