"""The configuration of a study; equal configurations give the same bytes."""

from collections.abc import Collection, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, ModelWrapValidatorHandler, model_validator

from oodscen import _paper as paper
from oodscen._entry_points import DEFAULT_LLM, is_builtin, name_fault, names
from oodscen._registry import DEFAULT_CATALOGUES, DEFAULT_ENCODER, DEFAULT_SIMULATOR
from oodscen._seeding import MAX_SEED
from oodscen._words.redaction import redact
from oodscen.data._base import Choices
from oodscen.data._reactions import LONGEST_REACTION_S, REACTIONS_S
from oodscen.prompts._scenario.describe_path import Style
from oodscen.protocols import Camera
from oodscen.stages._redteam.thresholds import (
    BROADENINGS,
    MOST_IN_FLIGHT,
    NEAREST_LABEL,
    NEAREST_TEXT,
    RarityBand,
    Similarity,
)


class StudyConfig(Choices):
    """Every choice that affects the results; the number of workers does not."""

    noun: ClassVar[str] = "study configuration"

    llm: str = DEFAULT_LLM
    """Tree-LLM and augmenter-LLM: `builtin`, or any name known to litellm."""
    red_llm: str | None = None
    """The red-LLM; `llm` if left out."""
    fallback: str | None = None
    """Model that is asked when `llm` or `red_llm` gives no answer."""
    vlms: tuple[str, ...] = ()
    """Vision-language models to judge; reference answerers always run."""
    protocols: tuple[Literal["ours", "paper"], ...] = ("ours",)
    """Judging protocols: `paper` adds the paper's protocol to ours."""
    asked: dict[str, tuple[Literal["ours", "paper"], ...]] = Field(default_factory=dict)
    """Judging protocols by model, where they differ from `protocols`."""
    chain: bool = False
    """Show a judged model its own descriptions of the frames before every question, as the paper does."""
    rear_view: bool = False
    """Show a judged model a picture from the rear window, taken at the decision, beside the words about who follows."""
    withheld: tuple[str, ...] = ()
    """Judged models that also answer the same questions without the pictures, in a row of their own."""
    ordinary: int = Field(default=1, ge=1, le=2)
    """Number of ordinary drives that go with a scene: its twin or its demand, or both."""
    people: tuple[str, ...] = ()
    """Names of the people whose answers to the quiz are judged."""
    judge: str | None = None
    """Model that decides whether an open aspect is right; the documented matcher if left out."""
    rarity_llm: str | None = None
    """Model that is asked for the rarity of the simulatable texts, beside the offline estimate."""
    recogniser: str | None = None
    """Vision model that names made things without their captions; what it does not name is dropped."""
    context: int | None = Field(default=None, ge=4_096)
    """Context window of `llm` in tokens, input and output; longer questions are shortened.

    If left out, questions take the tokens that they need, some 8,000.
    """
    api_base: str | None = None
    """Address of an OpenAI-compatible server for the models."""
    servers: dict[str, str] = Field(default_factory=dict)
    """Address by model, for models on another server than `api_base`."""
    simulator: str = DEFAULT_SIMULATOR
    catalogues: tuple[str, ...] | None = None
    """Other simulators' catalogues to prune the diverse tree for and compare.

    If left out: CARLA's if the built-in author judges, none where comparing would cost calls.
    """
    encoder: str = DEFAULT_ENCODER
    baseline: str | None = None
    """File of ordinary-driving texts; the shipped corpus if left out."""
    tree: str | None = Field(default=None, pattern="^[0-9a-f]{64}$")
    """Digest of the tree that the study was given, in place of one that `llm` grows; `nodes` then has no effect."""
    nodes: int = Field(default=paper.NODES["initial"], ge=12, le=2_000)
    """Size of the initial tree."""
    iterations: int = Field(default=paper.ITERATIONS, ge=0, le=100_000)
    """Rounds of red teaming."""
    closed_loop: bool = True
    """Show the red-LLM what is covered and refuse what is too similar; `False` is the paper's open loop."""
    red_budget: int | None = Field(default=None, ge=0)
    """Maximum number of model calls for red teaming."""
    red_patience: int | None = Field(default=None, ge=1)
    """Stop red teaming after this many rounds in a row without a new kind."""
    red_coverage: float | None = Field(default=None, gt=0.0, lt=1.0)
    """Stop red teaming when the Good-Turing coverage exceeds this."""
    in_flight: int = Field(default=1, ge=1, le=MOST_IN_FLIGHT)
    """Proposals in flight at once; each sees the tree as it was this many rounds ago."""
    nearest: Similarity = NEAREST_TEXT
    """Minimum similarity to an earlier proposal at which a proposal is refused."""
    nearest_label: Similarity = NEAREST_LABEL
    """Minimum similarity to a leaf's label at which a proposal is refused."""
    rarity: RarityBand | None = None
    """Band of rarity: proposals met about once in fewer or more kilometres are refused."""
    broadenings: int = Field(default=BROADENINGS, ge=0)
    """Number of broadenings of a leaf before it is split."""
    per_path: int = Field(default=paper.PER_PATH, ge=1, le=999)
    """Texts per path of the simulatable tree."""
    sets: tuple[int, ...] = paper.SETS
    """Sizes of the text sets from the diverse tree.

    If left out: the paper's if the built-in author writes about a tree of its own, none where they would cost calls.
    """
    style: Style = "natural"
    """Register of the texts."""
    candidates: int = Field(default=1, ge=1, le=100)
    """Texts written for each one that is kept; of several, the most diverse are kept."""
    twins: bool | None = None
    """Write every text's ordinary twin as well; by default only if the built-in author writes."""
    demands: bool = True
    """Make and run an ordinary demand beside every scene and its twin."""
    made: bool | None = None
    """Make the things that the simulator lacks, where nothing else keeps a branch from being shown.

    By default only if a model is asked, not the built-in author, and the simulator draws props.
    """
    max_paths: int | None = Field(default=None, ge=1)
    """Maximum number of paths to simulate; all if left out."""
    band: tuple[float, float] | None = None
    """OOD-ness band (paper, remark 1): scenarios outside it are not staged."""
    width: int = Field(default=Camera.width, ge=64, le=4096)
    """Columns of the frames, pixels."""
    height: int = Field(default=Camera.height, ge=48, le=4096)
    """Rows of the frames, pixels."""
    reaction: tuple[Annotated[float, Field(ge=0.0, le=LONGEST_REACTION_S)], ...] = Field(
        default=REACTIONS_S, min_length=1
    )
    """Reaction times of the drivers who try every action, s."""
    horizon: float | None = Field(default=None, gt=0.0, le=60.0)
    """Time for which an action is watched, s; each scene's own if left out."""
    frames: int = Field(default=3, ge=3, le=8)
    """Number of frames of a drive, at even distances in time."""
    seed: int = Field(default=0, ge=0, le=MAX_SEED)

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.band is not None and self.band[0] >= self.band[1]:
            raise ValueError("band: the lower bound must be below the upper one")
        if any(size < 1 for size in self.sets):
            raise ValueError("sets: sizes are positive")
        if self.judge is not None and is_builtin(self.judge):
            raise ValueError("judge: the built-in author writes texts; it judges no answers")
        if self.rarity_llm is not None and is_builtin(self.rarity_llm):
            raise ValueError(
                "rarity_llm: the built-in author estimates none; the offline head does"
            )
        if self.recogniser is not None and (
            self.recogniser == self.llm or is_builtin(self.recogniser)
        ):
            raise ValueError(
                "recogniser: it must be another model than the one that designs the props, and one that reads pictures"
            )
        named = [
            ("llm", name) for name in (*self.models, *self.asked, *self.withheld, *self.servers)
        ]
        for kind, name in (*named, ("encoder", self.encoder)):
            if fault := name_fault(kind, name):
                raise ValueError(fault)
        for address in filter(None, (self.api_base, *self.servers.values())):
            if redact(address) != address:
                raise ValueError(
                    f"{redact(address)}: an address with a key or password in it would be kept in "
                    "study.json; give the key in the environment, e.g. OPENAI_API_KEY"
                )
        return self

    @model_validator(mode="wrap")
    @classmethod
    def _with_sets(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Give a model that is paid for, and a given tree, no text sets of their own accord."""
        if isinstance(value, Mapping) and value.get("sets") is None:
            value = {name: item for name, item in value.items() if name != "sets"}
            is_own = is_builtin(str(value.get("llm", DEFAULT_LLM))) and not value.get("tree")
            if not is_own:
                value["sets"] = ()
        return handler(value)

    @classmethod
    def quick(cls, **changes: Any) -> Self:
        """Return a small but complete configuration that runs in seconds."""
        small = {
            "nodes": 24,
            "iterations": 10,
            "per_path": 1,
            "sets": (10,),
            "max_paths": 4,
        }
        return cls(**{**small, **changes})

    @property
    def camera(self) -> Camera:
        """The camera of the frames."""
        return Camera(width=self.width, height=self.height)

    def protocols_of(self, model: str) -> tuple[Literal["ours", "paper"], ...]:
        """Return the protocols that a model is judged by."""
        return self.asked.get(model, self.protocols)

    @property
    def models(self) -> tuple[str, ...]:
        """The names of all models that the study may ask."""
        names = (
            *(self.llm, self.red_llm, self.fallback, *self.vlms),
            *(self.judge, self.rarity_llm, self.recogniser),
        )
        return tuple(dict.fromkeys(name for name in names if name is not None))

    @property
    def compared(self) -> tuple[str, ...]:
        """The catalogues to compare with the simulator's."""
        if self.catalogues is None:
            if not is_builtin(self.llm):
                return ()
            installed = set(names("catalogue"))
            return tuple(name for name in DEFAULT_CATALOGUES if name in installed)
        return tuple(name for name in self.catalogues if name != self.simulator)

    def judging_too(self, other: Self, chosen: Collection[str] = ()) -> Self:
        """Return this configuration plus everything about another's judging; its own judge wins.

        Every model keeps the protocols that it was judged by, and gets those of this configuration if that
        names it. `SHARED` fields are the other's, except for `chosen` ones.
        """
        both = tuple(dict.fromkeys((*other.protocols, *self.protocols)))
        vlms = tuple(dict.fromkeys((*other.vlms, *self.vlms)))
        asked = {}
        for name in vlms:
            old = other.protocols_of(name) if name in other.vlms else ()
            new = self.protocols_of(name) if name in self.vlms else ()
            asked[name] = tuple(protocol for protocol in both if protocol in (*old, *new))
        return self.model_copy(
            update={
                "vlms": vlms,
                "protocols": both,
                "asked": {
                    name: protocols for name, protocols in asked.items() if protocols != both
                },
                "withheld": tuple(dict.fromkeys((*other.withheld, *self.withheld))),
                "people": tuple(dict.fromkeys((*other.people, *self.people))),
                "judge": self.judge or other.judge,
                "servers": other.servers | self.servers,
                **{name: getattr(other, name) for name in SHARED if name not in chosen},
            }
        )

    def differences(self, other: Self) -> dict[str, tuple[object, object]]:
        """Return the fields that differ, each with this configuration's value and the other's."""
        return {
            name: (getattr(self, name), getattr(other, name))
            for name in type(self).model_fields
            if getattr(self, name) != getattr(other, name)
        }


SHARED = ("chain", "rear_view", "ordinary")
"""Fields on how all judged models are asked; they are kept as soon as a model has answered."""

CHANGEABLE = (
    *SHARED,
    "vlms",
    "protocols",
    "asked",
    "withheld",
    "people",
    "judge",
    "servers",
    "api_base",
)
"""Fields that may change in a study: the judge, the judged models, how they are judged, and where models are reached."""

Status = Literal["running", "stopped", "success", "incomplete"]
"""The state of a run.

`stopped`: a cap was reached, an author's endpoint was given up, or the run was interrupted. `incomplete`: the
run ended, but some items failed.
"""
