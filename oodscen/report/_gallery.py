"""The scenes as one JSON document, from which the page's script builds the gallery.

It holds plain values only: the script inserts texts as text, and addresses are checked here.
"""

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from oodscen._words.decimals import seconds, speed
from oodscen.data._bird_sketch import Sketch
from oodscen.data._episode import ACTIONS, MOMENTS, Episode, in_order
from oodscen.data._pairing import demand_id, is_ordinary, twin_id
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.data._verdict import Verdict
from oodscen.data._weather import DUSK_DEG, FOG_M, Weather
from oodscen.errors import UnknownComponent, UsageError
from oodscen.judging._leaderboard.scored_rows import outcome_of
from oodscen.report import _phrasing as words
from oodscen.report._charts.canvas import signed
from oodscen.report._charts.frames import picture
from oodscen.report._load import Material, number

_STAGES = {"scenarios": "text", "scenes": "staging", "episodes": "simulation"}
_LONGEST = 4_000
"""Longest answer on the page, in characters; the study's files hold it in full."""
_LOW_SUN_DEG = 3.0
"""Elevation of the sun below which it is twilight, degrees."""
_SLIPPERY = 0.5
"""Friction up to which a road is slippery."""

Row = dict[str, Any]


def payload(material: Material, folder: Path) -> Row:
    """Return the data about the scenes for the page's script.

    Args:
        material: The study.
        folder: Folder of the study, which holds its frames.
    """
    gallery = _Gallery(material, folder)
    rows = [gallery.scene(name) for name in gallery.names]
    order = {leaf: index for index, leaf in enumerate(gallery.leaves)}
    rows.sort(key=lambda row: order[row["leaf"]])
    tree = material.trees.get("simulatable")
    attested = {leaf.id for leaf in tree.leaves if leaf.attested} if tree else set()
    return {
        "leaves": {
            leaf: {"path": list(gallery.leaves[leaf][1:]), "attested": leaf in attested}
            for leaf in dict.fromkeys(row["leaf"] for row in rows)
        },
        "models": [
            {"name": name, "kind": kind} for name, kind in _kinds(material.verdicts).items()
        ],
        "scenes": rows,
    }


class _Gallery:
    """A study's scenes and ordinary drives, with all that is known of each, by id."""

    def __init__(self, material: Material, folder: Path) -> None:
        self._folder = folder
        self._scenarios = {row.id: row for row in material.scenarios}
        self._scenes = {row.id: row for row in material.scenes}
        self._demands = {row.id: row for row in material.demands}
        self._episodes = {row.scene_id: row for row in material.episodes}
        self._failed = {
            failure.id: f"{_STAGES[failure.stage]} failed: {failure.error}"
            for failure in material.failures
            if failure.stage in _STAGES
        }
        self._scores, self._band = _scores(material), _band(material.config)
        index_of = {name: index for index, name in enumerate(_kinds(material.verdicts))}
        self._answers: dict[str, list[Row]] = {}
        for verdict in material.verdicts:
            row = _answer(verdict, index_of[_name(verdict)])
            self._answers.setdefault(verdict.scene_id, []).append(row)
        tree = material.trees.get("simulatable")
        self.leaves: dict[str, tuple[str, ...]] = dict(tree.paths) if tree else {}
        """The paths of the simulatable tree in order, followed by those of scenes without a leaf in it."""

    @property
    def names(self) -> list[str]:
        """Ids of everything that was to become a scene, in order."""
        names = (*self._scenarios, *self._scenes, *self._episodes, *self._failed)
        return [name for name in dict.fromkeys(names) if not is_ordinary(name)]

    def scene(self, name: str) -> Row:
        """Return a scene with its ordinary drives."""
        scene = self._scenes.get(name)
        scenario = self._scenarios.get(scene.scenario_id if scene else name)
        score, nearest = self._scores.get(scenario.id if scenario else name, (None, ""))
        leaf = _leaf(name, scenario, self.leaves)
        self.leaves.setdefault(leaf, scenario.path if scenario else ())
        return {
            "id": name,
            "leaf": leaf,
            "text": scenario.text if scenario else "",
            "score": "" if score is None else signed(score),
            "nearest": nearest,
            "error": self._failed.get(name, ""),
            "state": "" if name in self._failed else self._state(name, score),
            **self._shown(name, scene),
            "twin": self._twin(twin_id(name), scenario, scene),
            "demand": self._demand(demand_id(name)),
        }

    def _state(self, name: str, score: float | None) -> str:
        """Return how far a scene has come, if it has not been simulated."""
        if name in self._scenes:
            return "" if name in self._episodes else "Not simulated yet."
        if self._band and score is not None and not self._band[0] <= score <= self._band[1]:
            low, high = map(signed, self._band)
            return f"Not staged: its OOD-ness lies outside the band from {low} to {high}."
        return "Not staged yet."

    def _twin(self, name: str, scenario: Scenario | None, scene: Scene | None) -> Row | None:
        """Return the ordinary twin of a scene, if it was simulated."""
        episode, staged = self._episodes.get(name), None
        if scene is not None and episode is not None and episode.decision_s is not None:
            with suppress(UsageError, ValueError):
                staged = scene.twin(episode.decision_s)
        return self._ordinary(name, (scenario.ordinary or "") if scenario else "", staged)

    def _demand(self, name: str) -> Row | None:
        """Return the ordinary demand of a scene, if one was run or none fits."""
        scene = self._demands.get(name)
        return self._ordinary(name, scene.demand.text if scene and scene.demand else "", scene)

    def _ordinary(self, name: str, text: str, scene: Scene | None) -> Row | None:
        if name not in self._episodes and name not in self._failed:
            return None
        return {"text": text, "error": self._failed.get(name, ""), **self._shown(name, scene)}

    def _shown(self, name: str, scene: Scene | None) -> Row:
        """Return the appearance of a drive, the outcome of every action, and the answers about it."""
        episode = self._episodes.get(name)
        names = (
            {actor.id: words.plain_words(actor.asset) for actor in scene.actors} if scene else {}
        )
        return {
            "map": words.plain_words(scene.map) if scene else "",
            "weather": conditions(scene.weather) if scene else [],
            "setting": _setting(scene) if scene else "",
            "badWeather": scene is not None and scene.hazard.weather is not None,
            "players": _players(scene) if scene else [],
            "hazards": sorted(scene.hazard.actors) if scene else [],
            "decision": _decision(scene, episode, names) if scene else "",
            "choice": choice(episode) if episode else "",
            "frames": _frames(episode, self._folder) if episode else [],
            "actions": _outcomes(episode, names) if episode else [],
            "sketch": _sketch(episode.sketch, names) if episode and episode.sketch else None,
            "followed": bool(episode and episode.followers),
            "facts": _facts(episode, names) if episode else [],
            "answers": self._answers.get(name, []),
        }


def choice(episode: Episode) -> str:
    """Return which available actions are safe, leaving out marginal ones.

    Returns:
        `mixed`, `all`, `none`, or empty if none is available.
    """
    if all(outcome.unavailable for outcome in episode.actions.values()):
        return ""
    if not episode.safe_set:
        return "none"
    return "mixed" if episode.is_decidable else "all"


def conditions(weather: Weather) -> list[str]:
    """Return the filter terms that match a weather."""
    sun = weather.sun_elevation_deg
    light = "day"
    if sun < _LOW_SUN_DEG:
        light = "night" if sun <= DUSK_DEG else "twilight"
    adverse = []
    if weather.fog_visual_range_m < FOG_M:
        adverse.append("fog")
    if weather.precipitation != "none":
        adverse.append(weather.precipitation)
    if weather.friction <= _SLIPPERY:
        adverse.append("slippery road")
    return [light, *(adverse or ["clear"])]


def _name(verdict: Verdict) -> str:
    return verdict.model if verdict.protocol == "ours" else f"{verdict.model} (paper’s protocol)"


def _kinds(verdicts: Sequence[Verdict]) -> dict[str, str]:
    """Return the kind of every answerer; models come before references."""
    kinds = {_name(verdict): verdict.kind for verdict in verdicts}
    return dict(sorted(kinds.items(), key=lambda item: (item[1] == "reference", item[0])))


def _leaf(name: str, scenario: Scenario | None, leaves: Collection[str]) -> str:
    """Return the leaf that an item belongs to; ids are `<leaf>` or `<leaf>-003`."""
    if scenario is not None and scenario.leaf:
        return scenario.leaf
    return next((leaf for leaf in (name, name.rpartition("-")[0]) if leaf in leaves), "other")


def _frames(episode: Episode, folder: Path) -> list[Row]:
    if episode.status == "failed":
        return []
    times = episode.frame_times_s
    rows = []
    for moment in _moments(episode):
        frame = picture(folder, episode.frames.get(moment))
        caption = f"{moment} · {seconds(times[moment])}" if moment in times else moment
        rows.append(
            {"moment": moment, "caption": caption, "href": frame.href, "problem": frame.problem}
        )
    return rows


def _moments(episode: Episode) -> tuple[str, ...]:
    """Return the moments of an episode's frames in order of time; if one is no moment, all as they were recorded."""
    try:
        return in_order(episode.frames or MOMENTS)
    except UnknownComponent:
        return tuple(episode.frames)


def _outcomes(episode: Episode, names: Mapping[str, str]) -> list[Row]:
    outcomes = dict(sorted(episode.actions.items(), key=lambda item: _rank(item[0])))
    return [
        {
            "id": action,
            "name": words.plain_words(action),
            "kind": outcome.label,
            "note": words.outcome(outcome, names),
            "more": words.measures(outcome),
            "hits": list(outcome.contacts),
        }
        for action, outcome in outcomes.items()
    ]


def _rank(action: str) -> int:
    return ACTIONS.index(action) if action in ACTIONS else len(ACTIONS)


def _sketch(sketch: Sketch, names: Mapping[str, str]) -> Row:
    """Return a sketch as lists of numbers."""
    return {
        "lanes": [[lane.kind, lane.direction, lane.right, lane.left] for lane in sketch.lanes],
        "bodies": {
            name: [body.x, body.y, body.heading_deg, body.length, body.width]
            for name, body in sketch.bodies.items()
        },
        "names": {name: names[name] for name in sketch.bodies if name in names},
        "paths": {action: list(path) for action, path in sketch.paths.items()},
        "ends": {
            action: {name: list(end) for name, end in ends.items()}
            for action, ends in sketch.ends.items()
        },
    }


def _answer(verdict: Verdict, model: int) -> Row:
    """Return the answers of one answerer about one item; those of references are abridged."""
    row: Row = {
        "model": model,
        "outcome": outcome_of(verdict),
        "ood": verdict.is_ood,
        "action": verdict.action or "",
        "safe": verdict.action_is_safe,
        "marginal": verdict.action_is_marginal,
        "choice": verdict.choice or "",
        "chosen": verdict.choice_is_right,
        "named": verdict.aspect_is_right,
    }
    if verdict.kind == "reference":
        return row
    return {
        **row,
        "sure": verdict.confidence,
        "aspect": _cut(verdict.aspect),
        "error": _cut(verdict.error or ""),
        "descriptions": [_cut(text) for text in verdict.descriptions],
        "reasoning": _cut(verdict.reasoning),
        "contradiction": _cut(verdict.contradiction),
        "notes": [_cut(note) for note in verdict.notes],
        "judge": verdict.judge,
        "outdated": verdict.is_outdated,
    }


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]} … ({len(text):,} characters)"


def _scores(material: Material) -> dict[str, tuple[float, str]]:
    """Return OOD-ness and nearest ordinary text by scenario, if scores and texts match."""
    report = material.metrics and material.metrics.sets.get("simulatable")
    if not report or len(report.oodness.per_text) != len(material.scenarios):
        return {}
    rows = zip(material.scenarios, report.oodness.per_text, report.oodness.nearest, strict=True)
    return {scenario.id: (value, nearest.text) for scenario, value, nearest in rows}


def _band(config: Mapping[str, Any]) -> tuple[float, float] | None:
    bounds = config.get("band")
    if not isinstance(bounds, list) or len(bounds) != 2:
        return None
    low, high = number(bounds[0]), number(bounds[1])
    return None if low is None or high is None else (low, high)


def _setting(scene: Scene) -> str:
    parts = [words.plain_words(scene.map)]
    parts += words.map_faults(scene.map_state) if scene.map_state else []
    parts += [words.weather(scene.weather), f"ego at {speed(scene.ego.speed)}"]
    return " · ".join(parts)


def _players(scene: Scene) -> list[Row]:
    made = {prop.id: f"made to order: {prop.description}; " for prop in scene.made}
    motions = {motion.id: motion for motion in scene.motions}
    players = [
        {
            "name": words.actor_name(actor),
            "hazard": actor.id in scene.hazard.actors,
            "what": f"{made.get(actor.asset, '')}{words.place(actor.placement)}; {words.behaviour(actor.behaviour, motions)}",
        }
        for actor in scene.actors
    ]
    return sorted(players, key=lambda player: not player["hazard"])


def _decision(scene: Scene, episode: Episode | None, names: Mapping[str, str]) -> str:
    if scene.is_ordinary:
        return f"The ego must choose at {seconds(scene.decision.value)}, as in the scene."
    target = scene.decision.actor
    named = scene.decision.model_copy(
        update={"actor": f"the {names.get(target, target)}" if target else None}
    )
    when = words.trigger(named, "the ego", "the hazard")
    if episode is None or episode.decision_s is None:
        return f"The ego must choose {when}."
    if not episode.decision_fired:
        return f"The ego must choose {when}; that never came about, so the end of the approach at {seconds(episode.decision_s)} was taken."
    return f"The ego must choose {when}: at {seconds(episode.decision_s)}."


def _facts(episode: Episode, names: Mapping[str, str]) -> list[list[str]]:
    """Return the facts about a run that were noted, each with its name."""
    facts = {
        "Determinism": ""
        if episode.is_deterministic
        else "replaying the approach gave another trace; no action is called safe",
        "Re-staged": episode.restaged,
        "Hazard at the decision": _sighting(episode, names),
        "Behind the ego": _followers(episode, names),
        "Speed at the decision": ""
        if episode.ego_speed_mps is None
        else f"{episode.ego_speed_mps:.1f} m/s",
        "Drivers of every action": _reactions(episode),
        "Seen in the last frame": _seen(episode, names),
        "Run": episode.simulator
        and f"{episode.simulator}, seed {episode.seed}, step {words.amount(episode.dt)} s",
        "Trace": episode.trace_sha256[:16],
    }
    return [[name, fact] for name, fact in facts.items() if fact]


def _sighting(episode: Episode, names: Mapping[str, str]) -> str:
    sighting = episode.sighting
    if sighting is None:
        return ""
    name = names.get(sighting.actor, words.plain_words(sighting.actor))
    size = f"{sighting.height_px:g} pixels high in a picture of 480 rows"
    faults = f"; not judged, since it is {' and '.join(sighting.faults)}" if sighting.faults else ""
    return f"{name}, {size}, {sighting.distance_m:g} m away{faults}"


def _followers(episode: Episode, names: Mapping[str, str]) -> str:
    listed = ", ".join(names.get(name, words.plain_words(name)) for name in episode.followers)
    near = episode.follower
    if not listed or near is None:
        return listed
    return f"{listed}; the nearest {near.gap_m:.1f} m behind at {near.speed_mps:.1f} m/s"


def _reactions(episode: Episode) -> str:
    if not episode.reaction_s:
        return ""
    times = ", ".join(f"{reaction:g}" for reaction in episode.reaction_s)
    watched = "" if episode.horizon_s is None else f", each watched for {episode.horizon_s:g} s"
    return f"they react after {times} s{watched}"


def _seen(episode: Episode, names: Mapping[str, str]) -> str:
    last = sorted(episode.visible.get("last", {}).items(), key=lambda item: (-item[1], item[0]))
    return ", ".join(
        f"{names.get(name, words.plain_words(name))} {pixels} pixels" for name, pixels in last
    )
