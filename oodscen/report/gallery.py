"""The gallery: one section per path, one card per scene, failed ones included."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from oodscen.episode import ACTIONS, MOMENTS, Episode
from oodscen.report import charts, leaderboard, measures, words
from oodscen.report.reading import Material, by_key, number
from oodscen.report.thumbnails import Thumbnail, Thumbnails
from oodscen.scenario import Scenario
from oodscen.scene import Scene
from oodscen.verdict import Verdict

_STAGES = {"scenarios": "text", "scenes": "staging", "episodes": "simulation"}


@dataclass(frozen=True)
class Frame:
    """One of the three pictures of a scene."""

    picture: Thumbnail
    caption: str
    alt: str


@dataclass(frozen=True)
class Player:
    """One actor of a scene, in words."""

    name: str
    is_hazard: bool
    place: str
    behaviour: str


@dataclass(frozen=True)
class Chip:
    """What came of one action."""

    action: str
    kind: str
    """`safe`, `unsafe` or `unavailable`."""
    note: str


@dataclass(frozen=True)
class Card:
    """Everything the page says about one scene."""

    id: str
    path: tuple[str, ...]
    text: str
    oodness: str
    nearest: str
    """The ordinary text that is nearest in meaning; empty where unknown."""
    error: str
    """Why it failed, with the stage; empty where it did not."""
    state: str
    """What is not there yet, for a scene that did not fail; empty where all is there."""
    frames: tuple[Frame, ...]
    setting: str
    """Map, weather and the ego's speed."""
    weather_is_hazard: bool
    players: tuple[Player, ...]
    decision: str
    chips: tuple[Chip, ...]
    choice: str
    """`mixed`, `all`, `none` or empty: see `leaderboard.choice`."""
    verdicts: tuple[Verdict, ...]
    """Of real models."""
    facts: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Section:
    """The scenes of one path."""

    anchor: str
    kind: str
    """The class of the path."""
    path: tuple[str, ...]
    attested: bool
    cards: tuple[Card, ...]


def sections(found: Material, thumbnails: Thumbnails) -> list[Section]:
    """Return all cards, path by path in the order of the simulatable tree."""
    tree = found.trees.get("simulatable")
    attested = {leaf.id for leaf in tree.leaves if leaf.attested} if tree else set()
    grouped: dict[str, list[Card]] = {}
    paths: dict[str, tuple[str, ...]] = dict(tree.paths) if tree else {}
    cards = _cards(found, thumbnails)
    for leaf, card in cards:
        grouped.setdefault(leaf, []).append(card)
        if card.path:
            paths.setdefault(leaf, card.path)
    order = {leaf: index for index, leaf in enumerate(paths)}
    return [
        Section(
            anchor=f"path-{leaf}",
            kind=paths[leaf][1] if len(paths.get(leaf, ())) > 1 else "",
            path=paths.get(leaf, ()),
            attested=leaf in attested,
            cards=tuple(grouped[leaf]),
        )
        for leaf in sorted(grouped, key=lambda leaf: (order.get(leaf, len(order)), leaf))
    ]


def is_twin(name: str) -> bool:
    """Whether an id belongs to the ordinary twin of a scene."""
    return name.endswith("~twin")


def _cards(found: Material, thumbnails: Thumbnails) -> list[tuple[str, Card]]:
    scenarios = by_key(found.scenarios, lambda row: row.id)
    scenes = by_key(found.scenes, lambda row: row.id)
    episodes = by_key(found.episodes, lambda row: row.scene_id)
    errors = {
        failure.id: f"{_STAGES[failure.stage]} failed: {failure.error}"
        for failure in found.failures
        if failure.stage in _STAGES
    }
    judged: dict[str, list[Verdict]] = {}
    for verdict in found.verdicts:
        if verdict.kind == "model":
            judged.setdefault(verdict.scene_id, []).append(verdict)
    scores = _scores(found)
    band = _band(found.config)
    tree = found.trees.get("simulatable")
    leaves = {leaf.id for leaf in tree.leaves} if tree else set()
    ids = dict.fromkeys((*scenarios, *scenes, *episodes, *errors))
    cards = []
    for name in ids:
        if is_twin(name):
            continue
        scene = scenes.get(name)
        scenario = scenarios.get(scene.scenario_id if scene else name)
        card = _card(
            name, scenario, scene, episodes.get(name), errors.get(name, ""), thumbnails,
            scores.get(scenario.id if scenario else name, (None, "")), tuple(judged.get(name, ())), band,
        )  # fmt: skip
        cards.append((_leaf(name, scenario, leaves), card))
    return cards


def _leaf(name: str, scenario: Scenario | None, leaves: Collection[str]) -> str:
    """Return the leaf that an item belongs to; ids are `<leaf>` or `<leaf>-003`."""
    if scenario is not None and scenario.leaf:
        return scenario.leaf
    return next((leaf for leaf in (name, name.rpartition("-")[0]) if leaf in leaves), "other")


def _card(
    name: str,
    scenario: Scenario | None,
    scene: Scene | None,
    episode: Episode | None,
    error: str,
    thumbnails: Thumbnails,
    score: tuple[float | None, str],
    verdicts: tuple[Verdict, ...],
    band: tuple[float, float] | None,
) -> Card:
    names = {actor.id: words.plain(actor.asset) for actor in scene.actors} if scene else {}
    return Card(
        id=name,
        path=scenario.path if scenario else (),
        text=scenario.text if scenario else "",
        oodness="" if score[0] is None else charts.signed(score[0]),
        nearest=score[1],
        error=error,
        state="" if error else _state(scene, episode, score[0], band),
        frames=_frames(name, episode, thumbnails),
        setting=_setting(scene),
        weather_is_hazard=scene is not None and scene.hazard.weather is not None,
        players=_players(scene),
        decision=_decision(scene, episode, names),
        chips=_chips(episode, names),
        choice=leaderboard.choice(episode) if episode else "",
        verdicts=verdicts,
        facts=_facts(episode),
    )


def _scores(found: Material) -> dict[str, tuple[float, str]]:
    """Return OOD-ness and nearest ordinary text by scenario, where scores and texts agree."""
    values = measures.scores(found.metrics, "simulatable")
    if len(values) != len(found.scenarios):
        return {}
    near = measures.neighbours(found.metrics, "simulatable")
    near = near if len(near) == len(values) else [""] * len(values)
    return {
        scenario.id: (value, text)
        for scenario, value, text in zip(found.scenarios, values, near, strict=True)
    }


def _state(
    scene: Scene | None,
    episode: Episode | None,
    score: float | None,
    band: tuple[float, float] | None,
) -> str:
    if scene is None:
        if band and score is not None and not band[0] <= score <= band[1]:
            low, high = map(charts.signed, band)
            return f"Not staged: its OOD-ness lies outside the band from {low} to {high}."
        return "Not staged yet."
    return "Not simulated yet." if episode is None else ""


def _band(config: Mapping[str, Any]) -> tuple[float, float] | None:
    bounds = config.get("band")
    if not isinstance(bounds, list) or len(bounds) != 2:
        return None
    low, high = number(bounds[0]), number(bounds[1])
    return None if low is None or high is None else (low, high)


def _frames(name: str, episode: Episode | None, thumbnails: Thumbnails) -> tuple[Frame, ...]:
    if episode is None or episode.status == "failed":
        return ()
    times = _times(episode)
    return tuple(
        Frame(
            picture=thumbnails.make(moment, episode.frames.get(moment)),
            caption=f"{moment} · {times[moment]}" if moment in times else moment,
            alt=f"{moment.capitalize()} frame of {name}",
        )
        for moment in MOMENTS
    )


def _times(episode: Episode) -> Mapping[str, str]:
    """Return when the frames were taken: at the start, half way, and at the decision."""
    if episode.decision_s is None or episode.dt <= 0:
        return {}
    steps = round(episode.decision_s / episode.dt)
    return {
        moment: f"{step * episode.dt:.1f} s"
        for moment, step in zip(MOMENTS, (0, steps // 2, steps), strict=True)
    }


def _setting(scene: Scene | None) -> str:
    if scene is None:
        return ""
    return f"{words.plain(scene.map)} · {words.weather(scene.weather)} · ego at {words.speed(scene.ego.speed)}"


def _players(scene: Scene | None) -> tuple[Player, ...]:
    if scene is None:
        return ()
    players = (
        Player(
            name=words.called(actor),
            is_hazard=actor.id in scene.hazard.actors,
            place=words.place(actor.placement),
            behaviour=words.behaviour(actor.behaviour),
        )
        for actor in scene.actors
    )
    return tuple(sorted(players, key=lambda player: not player.is_hazard))


def _decision(scene: Scene | None, episode: Episode | None, names: Mapping[str, str]) -> str:
    if scene is None:
        return ""
    target = scene.decision_actor
    named = scene.decision.model_copy(
        update={"actor": f"the {names.get(target, target)}" if target else None}
    )
    when = words.trigger(named, "the ego", "the hazard")
    if episode is None or episode.decision_s is None:
        return f"The ego must choose {when}."
    if not episode.decision_fired:
        return f"The ego must choose {when}; that never came about, so the end of the approach at {episode.decision_s:.1f} s was taken."
    return f"The ego must choose {when}: at {episode.decision_s:.1f} s."


def _chips(episode: Episode | None, names: Mapping[str, str]) -> tuple[Chip, ...]:
    if episode is None:
        return ()
    outcomes = dict(sorted(episode.actions.items(), key=lambda item: _rank(item[0])))
    return tuple(
        Chip(
            action=words.plain(action),
            kind="unavailable" if outcome.unavailable else "safe" if outcome.safe else "unsafe",
            note=words.outcome(outcome, names),
        )
        for action, outcome in outcomes.items()
    )


def _rank(action: str) -> int:
    return ACTIONS.index(action) if action in ACTIONS else len(ACTIONS)


def _facts(episode: Episode | None) -> tuple[tuple[str, str], ...]:
    if episode is None:
        return ()
    facts = []
    if not episode.is_deterministic:
        facts.append(
            ("Determinism", "replaying the approach gave another trace; no action is called safe")
        )
    last = episode.visible.get("last", {})
    if last:
        seen = sorted(last.items(), key=lambda item: (-item[1], item[0]))
        facts.append(
            ("Seen in the last frame", ", ".join(f"{name} {pixels} px" for name, pixels in seen))
        )
    if episode.simulator:
        facts.append(
            ("Run", f"{episode.simulator}, seed {episode.seed}, step {words.amount(episode.dt)} s")
        )
    if episode.trace_sha256:
        facts.append(("Trace", episode.trace_sha256[:16]))
    return tuple(facts)
