from ._aspects.matching import names_aspect as names_aspect
from ._drive_board import drive_board as drive_board
from ._leaderboard.leaderboard import leaderboard as leaderboard
from ._leaderboard.paper_example import paper_example as paper_example
from ._leaderboard.power import scenes_needed as scenes_needed
from ._parsing import read_action as read_action
