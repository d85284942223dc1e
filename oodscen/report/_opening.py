"""The words at the top of the page: about models, driving stacks, or what the study is for."""

from dataclasses import dataclass

from oodscen.judging._leaderboard.board import Leaderboard
from oodscen.judging._rates_in_words import percent
from oodscen.report._load import Material


@dataclass(frozen=True)
class Opening:
    """The subject of the page."""

    sentences: tuple[str, ...]
    has_models: bool
    """True if a vision-language model or a person was judged."""
    has_stacks: bool
    """True if a driving stack was."""
    is_top_view: bool
    """True if the simulator draws views from above only, about which no model is asked."""

    @property
    def is_of_stacks(self) -> bool:
        """True if the study tells of driving stacks only."""
        return self.has_stacks and not self.has_models


def opening(material: Material, board: Leaderboard) -> Opening:
    """Return the subject of the page, and its first sentences."""
    has_models = any(row.is_judged for row in board.standings)
    is_top_view = material.info.get("camera") == "top"
    if has_models:
        sentences = board.sentences()
    elif material.drives:
        drives = material.drive_board.sentences()
        sentences = [*drives, f"Brackets hold {percent(board.level)} intervals."]
    elif is_top_view:
        sentences = [
            f"These scenes are for driving stacks: {material.config.get('simulator')} draws views from above only, about "
            "which no vision-language model is asked. None has driven them yet."
        ]
    else:
        sentences = board.sentences()
    return Opening(tuple(sentences), has_models, bool(material.drives), is_top_view)
