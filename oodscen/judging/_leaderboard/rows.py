"""The scores of a leaderboard's rows: rates, figures and comparisons."""

from collections.abc import Sequence
from typing import Literal, get_args

from oodscen.data._base import Data
from oodscen.data._verdict import Protocol, is_without_pictures
from oodscen.statistics._intervals import Interval
from oodscen.statistics._significance import PairedTest

Task = Literal["detection", "open", "closed", "control"]
TASKS: tuple[Task, ...] = get_args(Task)
"""The tasks in which answerers are compared; Holm's correction treats each as one family."""

PRIVILEGED = "oracle"
"""The reference that knows the truth: a ceiling, never a baseline to beat."""
BLIND = ("constant:", "random", "blind")
"""Beginnings of the names of references that see no picture."""


class Rate(Data):
    """A count out of a number of items."""

    hits: int = 0
    n: int = 0
    """Items with an answer; the others are in `missing` and never count as wrong."""
    missing: int = 0
    """Items without an answer: refused, not understood, timed out or failed."""
    value: float | None = None
    """In [0, 1]; `None` if `n` is 0."""
    with_missing_wrong: float | None = None
    """The share with every missing answer counted as wrong; `None` if nothing was asked."""
    interval: Interval | None = None
    paths: int = 0
    """Number of paths that the items cover."""


class Estimate(Data):
    """A figure other than a plain count."""

    value: float | None = None
    n: int = 0
    interval: Interval | None = None


class Detection(Data):
    """Task 1, detection: is anything out of the ordinary? Asked about scenes and their ordinary twins."""

    sensitivity: Rate = Rate()
    """Scenes that were called out of the ordinary."""
    specificity: Rate = Rate()
    """Ordinary drives that were not called out of the ordinary."""
    alarms: Rate = Rate()
    """Ordinary drives that were called out of the ordinary."""
    alarms_by_kind: dict[str, Rate] = {}
    """`alarms` by kind of ordinary drive (`twin` ...)."""
    balanced_accuracy: Estimate = Estimate()
    """Mean of sensitivity and specificity; 0.5 for an answerer that always says the same."""
    with_missing_wrong: Estimate = Estimate()
    """Balanced accuracy with every missing answer counted as wrong."""
    auroc: Estimate = Estimate()
    """Probability that a scene is rated above a twin by the stated confidence; 0.5 is chance."""
    d_prime: Estimate = Estimate()
    """Sensitivity index d'; 0 if scenes and twins are called OOD equally often."""
    stated: int = 0
    """Answers with a stated confidence; answers without one count as certain."""


class Identification(Data):
    """Task 1, identification: which aspect is unusual? Asked about scenes."""

    open: Rate = Rate()
    """Answers in the model's own words, scored by the matcher or a judge."""
    open_shown: Rate = Rate()
    """`open` under the paper's protocol, over the scenes whose frames show the hazard."""
    closed: Rate = Rate()
    """Answers chosen from a list of leaves."""
    judged: int = 0
    """Open aspects scored by a judge model."""
    unjudged: int = 0
    """Open aspects on which the judge gave no usable answer, so that the matcher scored them."""


class ActionScore(Data):
    """Task 2, control: choose an action, which the simulator executed."""

    safe: Rate = Rate()
    """Over all scenes: the ego touched nothing, stayed on the road and ran no red light."""
    collision_free: Rate = Rate()
    """The paper's success: the action could be executed and the ego touched nothing."""
    decidable: Rate = Rate()
    """Over the scenes in which one action is safe and another, which can be executed, is not: a safe one was chosen."""
    chance: float | None = None
    """The score of a random action on those decidable scenes."""
    above_chance: Estimate = Estimate()
    """`decidable` corrected for chance: 0 is a random choice, 1 is always safe."""
    ordinary_safe: Rate = Rate()
    """Over the ordinary twins: a safe action was chosen."""
    needless: Rate = Rate()
    """Over the twins in which keeping the speed is safe with enough margin
    (`oodscen.data._episode.has_enough_margin`): the action braked hard, stopped or pulled over.
    """
    needless_by_kind: dict[str, Rate] = {}
    """`needless` by kind of ordinary drive."""


class Gain(Data):
    """The lead over another answerer on the same items."""

    against: str
    """Model of the other row."""
    figure: Literal["notice", "act"]
    """The figure of `PairedScores`."""
    difference: Estimate


class PairedScores(Data):
    """The main figures: right about a scene and about the ordinary drives that go with it."""

    notice: Rate = Rate()
    """Scenes that are called out of the ordinary while none of their ordinary drives is."""
    act: Rate = Rate()
    """Scenes with a safe action whose ordinary drives all have a safe action that is neither a stop nor a lane
    change where keeping the speed is safe with enough margin."""
    act_by_kind: dict[str, Rate] = {}
    """`act` by kind of ordinary drive that goes with the scene."""
    drop: Estimate = Estimate()
    """Share of safe actions in the ordinary drives minus that in their scenes, in [-1, 1]."""
    over_blind: tuple[Gain, ...] = ()
    """Lead over the best answerer without the pictures: a constant, `random` or `blind`."""
    over_withheld: tuple[Gain, ...] = ()
    """Lead over the same model with the pictures withheld, the row `MODEL without pictures`."""


class SceneGroup(Data):
    """The scenes of one class, family or path."""

    level: Literal["class", "family", "path"]
    name: str
    parent: str = ""
    scenes: int = 0
    detected: Rate = Rate()
    open: Rate = Rate()
    closed: Rate = Rate()
    safe: Rate = Rate()
    chance: float | None = None
    """Probability that a random action is safe in these scenes."""


class Confusion(Data):
    """The number of times that the closed question took one path for another."""

    truth: str
    """Leaf id."""
    chosen: str
    """Leaf id, or `none`."""
    count: int


class LeaderboardRow(Data):
    """One row of the leaderboard."""

    model: str
    kind: Literal["model", "reference"] = "model"
    protocol: Protocol = "ours"
    asked: int = 0
    outcomes: dict[str, int] = {}
    """Number of verdicts by `oodscen.data._verdict.Outcome`."""
    contradictions: int = 0
    """Answers whose reasoning contradicts them."""
    outdated: int = 0
    """Answers to other versions of the questions than those of the last run."""
    paired: PairedScores = PairedScores()
    detection: Detection = Detection()
    identification: Identification = Identification()
    control: ActionScore = ActionScore()
    actions: dict[str, int] = {}
    """Number of times each action was chosen in scenes."""
    groups: tuple[SceneGroup, ...] = ()
    confusions: tuple[Confusion, ...] = ()
    """Wrong closed choices, most frequent first."""

    @property
    def is_blind(self) -> bool:
        """Return whether the row is that of a reference that sees no picture, judged by our protocol."""
        is_reference = self.kind == "reference" and self.protocol == "ours"
        return is_reference and self.model.startswith(BLIND)

    @property
    def is_judged(self) -> bool:
        """Return whether the row is that of a model that saw the pictures."""
        return self.kind == "model" and not is_without_pictures(self.model)


class ModelComparison(Data):
    """The comparison of two answerers on the same items."""

    task: Task
    against: Literal["model", "floor"]
    """Another model, or the best reference that does not know the truth."""
    first: str
    second: str
    test: PairedTest
    p_holm: float
    """McNemar's mid-p after Holm, over the comparisons of this task and kind."""
    p_clustered_holm: float
    """The path-clustered permutation's p after Holm: the one to quote."""
    missing: int = 0
    """Items that the first answerer was asked about and did not answer; against the floor only."""
    worst_difference: float | None = None
    """The difference with those counted as wrong; `None` between models."""
    p_worst_holm: float | None = None
    """`p_clustered_holm` with those counted as wrong."""


class ActionTally(Data):
    """The outcomes of one action over the scenes."""

    action: str
    safe: int = 0
    marginal: int = 0
    """Scenes in which it is safe for some drivers only."""
    unsafe: int = 0
    unavailable: int = 0


def best_floor(standings: Sequence[LeaderboardRow], task: Task) -> LeaderboardRow | None:
    """Return the best reference in a task that does not know the truth."""
    floors = [
        row
        for row in standings
        if row.kind == "reference"
        and not row.model.startswith(PRIVILEGED)
        and row.protocol == "ours"
        and score(row, task) is not None
    ]
    return max(floors, key=lambda row: score(row, task) or 0.0, default=None)


def rates(row: LeaderboardRow, task: Task) -> tuple[Rate, ...]:
    """Return the rates that count a task's answers: over scenes and twins in detection, over scenes elsewhere."""
    return {
        "detection": (row.detection.sensitivity, row.detection.specificity),
        "open": (row.identification.open,),
        "closed": (row.identification.closed,),
        "control": (row.control.safe,),
    }[task]


def score(row: LeaderboardRow, task: Task) -> float | None:
    """Return the figure that ranks a task."""
    if task == "detection":
        return row.detection.balanced_accuracy.value
    return rates(row, task)[0].value
