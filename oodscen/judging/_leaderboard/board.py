"""What a leaderboard holds: rates, figures, and who does better than whom."""

from collections.abc import Sequence
from typing import ClassVar, Literal

from oodscen.data._base import Data
from oodscen.data._verdict import Protocol
from oodscen.statistics._tests import Bounds, PairedTest

Task = Literal["detection", "open", "closed", "control"]
TASKS: tuple[Task, ...] = ("detection", "open", "closed", "control")
"""What two answerers are compared in; each is a family of its own for Holm's correction."""

PRIVILEGED = "oracle"
"""The reference that is told the truth: a ceiling, and no yardstick."""


class Rate(Data):
    """A count out of a number of items."""

    noun: ClassVar[str] = "rate"

    hits: int = 0
    n: int = 0
    """Items with an answer; the others are in `missing`, and never counted as wrong."""
    missing: int = 0
    """Items without an answer: refused, not understood, timed out, failed."""
    value: float | None = None
    """In [0, 1]; `None` where n is 0."""
    worst: float | None = None
    """The share with every missing answer counted as wrong; `None` where nothing was asked."""
    interval: Bounds | None = None
    paths: int = 0
    """Over how many paths the items spread."""


class Figure(Data):
    """A figure that is no plain count."""

    noun: ClassVar[str] = "figure"

    value: float | None = None
    n: int = 0
    interval: Bounds | None = None


class Detection(Data):
    """Task 1: is anything here out of the ordinary? Asked of scenes and of their ordinary twins."""

    noun: ClassVar[str] = "detection"

    sensitivity: Rate = Rate()
    """Scenes that were called out of the ordinary."""
    specificity: Rate = Rate()
    """Twins that were not."""
    balanced_accuracy: Figure = Figure()
    """Mean of both: 0.5 for whoever always says the same."""
    worst: Figure = Figure()
    """Balanced accuracy with every missing answer counted as wrong."""
    auroc: Figure = Figure()
    """How often a scene is rated above a twin, by the stated confidence; 0.5 is chance."""
    d_prime: Figure = Figure()
    """0 where scenes and twins are called OOD equally often."""
    stated: int = 0
    """Answers that came with a confidence; the others count as sure."""


class Identification(Data):
    """Task 1: which aspect is it? Asked of scenes."""

    noun: ClassVar[str] = "identification"

    open: Rate = Rate()
    """In own words, scored by the matcher or a judge."""
    open_shown: Rate = Rate()
    """`open` under the paper's protocol, of the scenes whose frames show the hazard."""
    closed: Rate = Rate()
    """One of the listed leaves."""
    judged: int = 0
    """Open aspects that a judge model scored."""
    unjudged: int = 0
    """Open aspects about which it gave no usable answer, so that the matcher scored them."""


class Control(Data):
    """Task 2: choose an action; it was executed in the simulator."""

    noun: ClassVar[str] = "control"

    safe: Rate = Rate()
    """Of all scenes: the ego touched nothing and stayed on the road."""
    collision_free: Rate = Rate()
    """The paper's success: the action could be executed, and the ego touched nothing."""
    decidable: Rate = Rate()
    """Of the scenes in which one action is safe and another is not: a safe one was chosen."""
    chance: float | None = None
    """What a random action scores on those decidable scenes."""
    above_chance: Figure = Figure()
    """`decidable` corrected for chance: 0 is a random choice, 1 is always safe."""
    twin_safe: Rate = Rate()
    """Of the ordinary twins: a safe action was chosen."""
    needless: Rate = Rate()
    """Of the twins in which keeping the speed is safe with enough margin
    (`oodscen.judging._safety.has_enough_margin`): it braked hard, stopped or pulled over."""


class Group(Data):
    """The scenes of one class, family or path."""

    noun: ClassVar[str] = "group"

    level: Literal["class", "family", "path"]
    name: str
    parent: str = ""
    scenes: int = 0
    detected: Rate = Rate()
    open: Rate = Rate()
    closed: Rate = Rate()
    safe: Rate = Rate()
    chance: float | None = None
    """How often a random action is safe in these scenes."""


class Confusion(Data):
    """How often one path was taken for another, in the closed question."""

    noun: ClassVar[str] = "confusion"

    truth: str
    """Leaf id."""
    chosen: str
    """Leaf id, or `none`."""
    count: int


class Standing(Data):
    """One row of the leaderboard."""

    noun: ClassVar[str] = "standing"

    model: str
    kind: Literal["model", "reference"] = "model"
    protocol: Protocol = "ours"
    asked: int = 0
    outcomes: dict[str, int] = {}
    """How judging ended, by `oodscen.data._verdict.Outcome`."""
    contradictions: int = 0
    """Answers whose reasoning says something else."""
    outdated: int = 0
    """Answers to other versions of the questions than those of the last run."""
    detection: Detection = Detection()
    identification: Identification = Identification()
    control: Control = Control()
    actions: dict[str, int] = {}
    """How often every action was chosen in scenes."""
    groups: tuple[Group, ...] = ()
    confusions: tuple[Confusion, ...] = ()
    """Wrong closed choices, most frequent first."""


class Comparison(Data):
    """Two answerers on the same items."""

    noun: ClassVar[str] = "comparison"

    task: Task
    against: Literal["model", "floor"]
    """Another model, or the best reference that sees no scene's secret."""
    first: str
    second: str
    test: PairedTest
    p_holm: float
    """McNemar's mid-p after Holm, over the comparisons of this task and kind."""
    p_clustered_holm: float
    """The path-clustered permutation's p after Holm: the one to quote."""
    missing: int = 0
    """Items that the first was asked about and did not answer: against the floor only."""
    worst_difference: float | None = None
    """The difference with those counted as wrong; `None` between models."""
    p_worst_holm: float | None = None
    """`p_clustered_holm` with those counted as wrong."""


class ActionTally(Data):
    """What one action leads to over the scenes."""

    noun: ClassVar[str] = "action tally"

    action: str
    safe: int = 0
    unsafe: int = 0
    unavailable: int = 0


class Leaderboard(Data):
    """Everything that the verdicts of a study come to."""

    noun: ClassVar[str] = "leaderboard"

    schema_version: Literal[1] = 1
    scenes: int = 0
    """Scenes that ran."""
    twins: int = 0
    paths: int = 0
    decidable: int = 0
    """Scenes in which one action is safe and another is not."""
    all_safe: int = 0
    none_safe: int = 0
    chance: float | None = None
    """How often a random action is safe, over all scenes that ran."""
    icc: float | None = None
    """Largest correlation of safe choices within a path, over the models (references without any)."""
    judge: str = ""
    """Who scored the open aspects, `<model>@<prompt version>`; empty for the matcher."""
    whole: int = 0
    """Scenes whose whole trace was shown under the paper's protocol."""
    whole_shown: int = 0
    """Those in which the hazard can be seen in one of the three frames."""
    actions: tuple[ActionTally, ...] = ()
    standings: tuple[Standing, ...] = ()
    """Models first, then references, each by safe action."""
    comparisons: tuple[Comparison, ...] = ()
    level: float = 0.95
    seed: int = 0

    def standing(self, model: str) -> Standing | None:
        """Return the row of a model."""
        return next((row for row in self.standings if row.model == model), None)

    def floor(self, task: Task) -> Standing | None:
        """Return the reference that does best in a task without knowing the truth."""
        return best_floor(self.standings, task)


def best_floor(standings: Sequence[Standing], task: Task) -> Standing | None:
    """Return the best reference in a task that is not told the truth."""
    seen = [
        (value, row)
        for row in standings
        if row.kind == "reference"
        and not row.model.startswith(PRIVILEGED)
        and row.protocol == "ours"
        and (value := score(row, task)) is not None
    ]
    return max(seen, key=lambda item: item[0], default=(0.0, None))[1]


def score(row: Standing, task: Task) -> float | None:
    """Return the figure by which a task is judged."""
    if task == "detection":
        return row.detection.balanced_accuracy.value
    rates = {
        "open": row.identification.open,
        "closed": row.identification.closed,
        "control": row.control.safe,
    }
    return rates[task].value


def worst_score(row: Standing, task: Task) -> float | None:
    """Return the figure by which a task is judged, every missing answer counted as wrong."""
    if task == "detection":
        return row.detection.worst.value
    rates = {
        "open": row.identification.open,
        "closed": row.identification.closed,
        "control": row.control.safe,
    }
    return rates[task].worst


def missing_share(row: Standing, task: Task) -> float:
    """Return the share of the items of a task that were asked about and not answered."""
    rates = {
        "detection": (row.detection.sensitivity, row.detection.specificity),
        "open": (row.identification.open,),
        "closed": (row.identification.closed,),
        "control": (row.control.safe,),
    }[task]
    asked = sum(rate.n + rate.missing for rate in rates)
    return sum(rate.missing for rate in rates) / asked if asked else 0.0
