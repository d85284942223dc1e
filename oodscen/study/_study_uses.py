"""Methods of a study that do what higher floors can do with it.

They are the only functions of this floor that call upwards, and import what they need when they are called.
"""

from collections.abc import Callable, Collection
from pathlib import Path
from typing import TYPE_CHECKING, cast

from oodscen._arguments import checked

if TYPE_CHECKING:
    from oodscen.publish._publishing import Form, Publication
    from oodscen.study._study import Study


class StudyUses:
    """The report of a study, and its publication as a data set."""

    @checked
    def write_report(
        self, require: str | None = None, *, warn: Callable[[str], None] | None = None
    ) -> Path:
        """Write `report.html` into the study's folder and return its path.

        The page needs only itself and, for the pictures, the folder `frames` beside it. Missing or broken
        parts of the study are replaced by a note. The same study gives the same bytes.

        Args:
            require: A requirement on the judged models, as `requirements` takes it, whose grades the page shows.
            warn: Called with every note on the page about a part that is missing or cannot be read.

        Raises:
            UsageError: If the requirement is malformed, or names an unknown figure.
            FolderTaken: If the folder holds no study, but a foreign file of this name.
            InUse: If another process is writing the study.
            StudyError: If the page cannot be written.
        """
        from oodscen.judging._leaderboard.requirements import parse_requirement
        from oodscen.report._render import write_report

        bars = () if require is None else parse_requirement(require)
        return write_report(_study(self), bars, warn=warn)

    def publish(
        self,
        out: str | Path,
        *,
        forms: "Collection[Form] | None" = None,
        validation: float = 0.2,
        licence: str = "cc-by-4.0",
    ) -> "Publication":
        """Write the study as a data set for the Hugging Face Hub.

        The Parquet files hold every question of the study with its pictures, and every drive with its scene and the
        outcomes of all actions. Kinds of situation are split between `validation` and `test`, never a kind between
        both. Names of drives and pictures tell nothing about what they show. Models that the study has judged are
        named in the card.

        Args:
            out: The folder, new or empty, or a data set that this replaces.
            forms: Forms for other tools to write beside the Parquet files: `vlmevalkit`, `lmms-eval` and `drivelm`;
                all by default.
            validation: Share of the kinds in the validation split.
            licence: Licence of the data as the Hub names it.

        Raises:
            DataError: If the study has no drives with frames, a frame is not the recorded one or cannot be shown, or
                a file of it is malformed.
            FolderTaken: If the folder holds other files, or is a part of a study.
            InUse: If another process writes the folder.
            MissingExtra: If pyarrow is not installed.
            StudyError: If a file cannot be written.
            UsageError: If `validation`, `licence` or `out` is invalid, a scene or its text has changed since it was
                run, a verdict does not belong to its drive, or the card of the earlier data set was changed since it
                was published.
        """
        from oodscen.publish._publishing import FORMS, publish

        chosen = FORMS if forms is None else forms
        return publish(_study(self), out, forms=chosen, validation=validation, licence=licence)


def _study(uses: StudyUses) -> "Study":
    """Return the study, which alone has these methods."""
    return cast("Study", uses)
