"""Verdicts that do not belong to the drives of a study as they are now: the one rule for everything that reads them."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

from oodscen._words.text import first_few, one_line
from oodscen.data._base import digest
from oodscen.data._episode import ACTIONS, Episode
from oodscen.data._pairing import scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Protocol, Verdict, verdict_id
from oodscen.errors import UsageError
from oodscen.judging._aspects.opinions import Opinion
from oodscen.judging._people import PersonAnswers, person
from oodscen.judging._scoring import is_scored
from oodscen.study._config import StudyConfig
from oodscen.study._judged import AnswerKeys, Judged, is_shown

if TYPE_CHECKING:
    from oodscen.study._store import Store
    from oodscen.study._study import Study

OPINIONS = "opinions.jsonl"
"""File with one line per judge model and distinct pair of open aspect and path that it was asked about."""

_SCORES = ("success", "action_is_safe", "choice_is_right", "thing_is_right", "aspect_is_right")
_ENDED = ("answered", "unavailable")
"""Outcomes of a drive of which every question was answered."""


class VerdictRule:
    """Tells the verdicts that belong to the drives of a study from all others.

    A verdict belongs if it was made from its drive and the truth about it as they are now, holds answers that can have
    been given, and is scored as these answers are. The run makes verdicts again by this rule, and readers refuse or
    leave out the others.

    Args:
        shown: The episodes that answerers are asked about, by protocol.
        scenarios: The texts.
        scenes: The scenes of the texts.
        config: The study's configuration.
        people: The people whose answers count.
    """

    def __init__(
        self,
        shown: Mapping[Protocol, Sequence[Episode]],
        scenarios: Sequence[Scenario],
        scenes: Sequence[Scene],
        config: StudyConfig,
        people: Iterable[PersonAnswers] = (),
    ) -> None:
        self._shown = {
            (name, episode.scene_id): episode
            for name, episodes in shown.items()
            for episode in episodes
        }
        self._truths = _truth_digests(shown, scenarios, scenes, config)
        self._people = {answers.name: answers.sha256 for answers in people}
        self._sources = scenarios, scenes, config.seed

    @cached_property
    def keys(self) -> AnswerKeys:
        """The keys to the answers."""
        scenarios, scenes, seed = self._sources
        return AnswerKeys(scenarios, scenes, seed=seed)

    def made_from(self, item: str, answerer: str, protocol: Protocol, *, is_reference: bool) -> str:
        """Return the digest of what a verdict on an item is made from; empty if the item is not asked about."""
        if (protocol, item) not in self._shown:
            return ""
        truth = self._truths[protocol, "" if is_reference else item]
        sha256 = self._people.get(answerer)
        return digest([truth, sha256]) if sha256 else truth

    def is_possible(self, verdict: Verdict) -> bool:
        """Return whether a verdict holds answers that can have been given about its drive."""
        is_ok = verdict.status == "ok"
        if is_ok != (verdict.outcome in _ENDED):
            return False
        if is_ok and (verdict.is_ood is None or verdict.action is None):
            return False
        episode = self._shown.get((verdict.protocol, verdict.scene_id))
        if episode is None or not is_shown(episode):
            return not is_ok and all(getattr(verdict, name) is None for name in _SCORES)
        if verdict.choice is not None:
            options = self.keys.of(episode, verdict.protocol).options
            if verdict.choice not in {option.id for option in options}:
                return False
        # Every action is offered, also where the simulator did not try it.
        return verdict.action is None or verdict.action in {*ACTIONS, *episode.actions}

    def belongs(self, verdict: Verdict, opinions: Mapping[str, Opinion]) -> bool:
        """Return whether a verdict belongs to its drive and is scored as its answers are.

        `opinions` are those of the judges, by id.
        """
        item, model, protocol = verdict.scene_id, verdict.model, verdict.protocol
        is_reference = verdict.kind == "reference"
        if verdict.id != verdict_id(item, model, protocol) or not verdict.made_from:
            return False
        if verdict.made_from != self.made_from(item, model, protocol, is_reference=is_reference):
            return False
        if not self.is_possible(verdict):
            return False
        episode = self._shown[protocol, item]
        return not is_shown(episode) or is_scored(
            verdict, self.keys.of(episode, protocol), opinions
        )


def _truth_digests(
    shown: Mapping[Protocol, Sequence[Episode]],
    scenarios: Sequence[Scenario],
    scenes: Sequence[Scene],
    config: StudyConfig,
) -> dict[tuple[Protocol, str], str]:
    """Return the digests of everything that verdicts depend on, by protocol and item.

    The empty item covers all items of this protocol and of those before it, since references may look at
    every episode.
    """
    texts = {scenario.id: [scenario.leaf, scenario.path] for scenario in scenarios}
    leaves = sorted({(scenario.leaf, *scenario.path[-1:]) for scenario in scenarios})
    maps = sorted((scene.id, scene.map) for scene in scenes)
    visible = {scene.id: [thing.model_dump() for thing in scene.visible] for scene in scenes}
    digests: dict[tuple[Protocol, str], str] = {}
    for protocol, episodes in shown.items():
        for episode in episodes:
            # The pixels count, not the bytes that hold them.
            content = episode.model_dump(mode="json", exclude={"file_sha256"})
            scene_id = scene_of(episode.scene_id)
            truth = [
                digest(content),
                texts.get(scene_id),
                leaves,
                maps,
                visible.get(scene_id),
                config.chain,
            ]
            if config.rear_view and protocol == "ours":
                truth.append("rear view")
            digests[protocol, episode.scene_id] = digest(truth)
        digests[protocol, ""] = digest(list(digests.values()))
    return digests


class Tables(NamedTuple):
    """The tables of a study that tell which verdicts belong to it."""

    store: "Store"
    """The study's files, which hold people's answers and judges' opinions."""
    config: StudyConfig
    episodes: Sequence[Episode]
    """The episodes of scenes, ordinary drives and demands."""
    whole: Sequence[Episode]
    """The episodes of the paper's protocol."""
    scenarios: Sequence[Scenario]
    scenes: Sequence[Scene]
    """The scenes without the demands."""

    @classmethod
    def of(cls, study: "Study") -> "Tables":
        """Return the tables of a study."""
        return cls(
            study.store,
            study.config,
            study.episodes,
            study.paper_episodes,
            study.scenarios,
            study.scenes,
        )

    def rule(self, people: Collection[str]) -> VerdictRule:
        """Return the rule by which verdicts belong to these tables; `people` are those whose answers count."""
        judged = Judged.of(self.episodes, self.scenes, self.config)
        shown: dict[Protocol, Sequence[Episode]] = {"ours": judged.asked}
        if "paper" in self.config.protocols:
            shown["paper"] = self.whole
        answers = [PersonAnswers.load(self.store, name, judged.episodes) for name in people]
        return VerdictRule(shown, self.scenarios, judged.scenes, self.config, answers)

    def stale(self, verdicts: Sequence[Verdict]) -> list[Verdict]:
        """Return the verdicts that do not belong to the drives of the study.

        Raises:
            DataError: If a table is malformed.
        """
        if not verdicts:
            return []
        answerers = {verdict.model for verdict in verdicts}
        people = [name for name in self.config.people if person(name) in answerers]
        rule, opinions = self.rule(people), dict[str, Opinion]()
        if any(verdict.judge for verdict in verdicts):
            for line in self.store.lines(OPINIONS):
                opinion = Opinion.parse(line, source=str(self.store.path(OPINIONS)))
                opinions[opinion.id] = opinion
        return [verdict for verdict in verdicts if not rule.belongs(verdict, opinions)]


def stale_in_words(stale: Sequence[Verdict]) -> str:
    """Return the sentence about verdicts that do not belong to the drives of a study."""
    models_first = sorted(stale, key=lambda verdict: verdict.kind != "model")
    answerers = first_few(list(dict.fromkeys(one_line(verdict.model) for verdict in models_first)))
    subject, were, again = f"1 verdict ({answerers}) does", "it was", "it"
    if len(stale) > 1:
        subject, were, again = f"{len(stale)} verdicts ({answerers}) do", "they were", "them"
    return (
        f"{subject} not belong to the drives of this study: {were} made from others, or edited; the same "
        f"`oodscen run OUT` makes {again} again"
    )


def refuse_stale_verdicts(study: "Study", verdicts: Sequence[Verdict]) -> None:
    """Refuse verdicts that do not belong to the drives of a study as they are now.

    Raises:
        UsageError: If one does not.
        DataError: If a table is malformed.
    """
    if stale := Tables.of(study).stale(verdicts):
        raise UsageError(f"{study.folder}: {stale_in_words(stale)}")
