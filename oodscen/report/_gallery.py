"""The scenes as one JSON document, from which the page's script builds the gallery.

It holds plain values only: the script inserts texts as text, and addresses are checked here.
"""

from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from oodscen.data._bird_sketch import Sketch
from oodscen.data._episode import ACTIONS, MOMENTS, Episode, in_order
from oodscen.data._pairing import demand_id, is_ordinary, twin_id
from oodscen.data._scenario import Scenario
from oodscen.data._scene import DUSK_DEG, FOG_M, Scene, Weather
from oodscen.data._verdict import Verdict
from oodscen.report import _phrasing as words
from oodscen.report._charts.canvas import signed
from oodscen.report._charts.frames import picture
from oodscen.report._load import Material, by_key, number

_STAGES = {"scenarios": "text", "scenes": "staging", "episodes": "simulation"}
_LONGEST = 4_000
"""Longest answer on the page, in characters; the study's files hold it in full."""

Row = dict[str, Any]


def payload(found: Material, folder: Path) -> Row:
    """Return the data about the scenes for the page's script.

    Args:
        found: The study.
        folder: Folder of the study, which holds its frames.
    """
    scenarios = by_key(found.scenarios, lambda row: row.id)
    scenes = by_key(found.scenes, lambda row: row.id)
    demands = by_key(found.demands, lambda row: row.id)
    episodes = by_key(found.episodes, lambda row: row.scene_id)
    failed = {
        failure.id: f"{_STAGES[failure.stage]} failed: {failure.error}"
        for failure in found.failures
        if failure.stage in _STAGES
    }
    models = _models(found.verdicts)
    answers: dict[str, list[Row]] = {}
    for verdict in found.verdicts:
        row = _answer(verdict, models[_name(verdict)])
        answers.setdefault(verdict.scene_id, []).append(row)
    scores, band = _scores(found), _band(found.config)
    leaves, attested = _leaves(found)
    rows = []
    for name in dict.fromkeys((*scenarios, *scenes, *episodes, *failed)):
        if is_ordinary(name):
            continue
        scene = scenes.get(name)
        scenario = scenarios.get(scene.scenario_id if scene else name)
        score = scores.get(scenario.id if scenario else name, (None, ""))
        leaf = _leaf(name, scenario, leaves)
        leaves.setdefault(leaf, scenario.path if scenario else ())
        rows.append(
            {
                "id": name,
                "leaf": leaf,
                "text": scenario.text if scenario else "",
                "score": "" if score[0] is None else signed(score[0]),
                "nearest": score[1],
                "error": failed.get(name, ""),
                "state": ""
                if name in failed
                else _state(scene, episodes.get(name), score[0], band),
                **_shown(name, scene, episodes.get(name), folder),
                "answers": answers.get(name, []),
                "twin": _twin(name, scenario, scene, episodes, failed, folder, answers),
                "demand": _demand(demand_id(name), demands, episodes, failed, folder, answers),
            }
        )
    order = {leaf: index for index, leaf in enumerate(leaves)}
    rows.sort(key=lambda row: order[row["leaf"]])
    used = dict.fromkeys(row["leaf"] for row in rows)
    return {
        "leaves": {
            leaf: {"path": list(leaves[leaf][1:]), "attested": leaf in attested} for leaf in used
        },
        "models": [{"name": name, "kind": kind} for name, kind in _kinds(found.verdicts).items()],
        "scenes": rows,
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
    found = ["night" if weather.sun_elevation_deg <= DUSK_DEG else "twilight" if weather.sun_elevation_deg < 3 else "day"]  # fmt: skip
    if weather.fog_visual_range_m < FOG_M:
        found.append("fog")
    if weather.precipitation != "none":
        found.append(weather.precipitation)
    if weather.friction <= 0.5:
        found.append("slippery road")
    return found if len(found) > 1 else [*found, "clear"]


def _name(verdict: Verdict) -> str:
    return verdict.model if verdict.protocol == "ours" else f"{verdict.model} (paper’s protocol)"


def _kinds(verdicts: Sequence[Verdict]) -> dict[str, str]:
    """Return the kind of every answerer; models come before references."""
    kinds = {_name(verdict): verdict.kind for verdict in verdicts}
    return dict(sorted(kinds.items(), key=lambda item: (item[1] == "reference", item[0])))


def _models(verdicts: Sequence[Verdict]) -> dict[str, int]:
    return {name: index for index, name in enumerate(_kinds(verdicts))}


def _leaves(found: Material) -> tuple[dict[str, tuple[str, ...]], set[str]]:
    """Return the paths of the simulatable tree in order, and the leaves that the paper attests."""
    tree = found.trees.get("simulatable")
    if tree is None:
        return {}, set()
    return dict(tree.paths), {leaf.id for leaf in tree.leaves if leaf.attested}


def _leaf(name: str, scenario: Scenario | None, leaves: Collection[str]) -> str:
    """Return the leaf that an item belongs to; ids are `<leaf>` or `<leaf>-003`."""
    if scenario is not None and scenario.leaf:
        return scenario.leaf
    return next((leaf for leaf in (name, name.rpartition("-")[0]) if leaf in leaves), "other")


def _twin(
    name: str,
    scenario: Scenario | None,
    scene: Scene | None,
    episodes: Mapping[str, Episode],
    failed: Mapping[str, str],
    folder: Path,
    answers: Mapping[str, list[Row]],
) -> Row | None:
    """Return the ordinary twin of a scene, if it was simulated."""
    twin = twin_id(name)
    episode = episodes.get(twin)
    if episode is None and twin not in failed:
        return None
    staged = None
    if scene is not None and episode is not None and episode.decision_s is not None:
        with suppress(ValueError):
            staged = scene.twin(episode.decision_s)
    return {
        "text": (scenario.ordinary or "") if scenario else "",
        "error": failed.get(twin, ""),
        **_shown(twin, staged, episode, folder),
        "answers": answers.get(twin, []),
    }


def _demand(
    name: str,
    demands: Mapping[str, Scene],
    episodes: Mapping[str, Episode],
    failed: Mapping[str, str],
    folder: Path,
    answers: Mapping[str, list[Row]],
) -> Row | None:
    """Return the ordinary demand of a scene, if one was run or none fits."""
    episode, scene = episodes.get(name), demands.get(name)
    if episode is None and name not in failed:
        return None
    return {
        "text": scene.demand.text if scene and scene.demand else "",
        "error": failed.get(name, ""),
        **_shown(name, scene, episode, folder),
        "answers": answers.get(name, []),
    }


def _shown(name: str, scene: Scene | None, episode: Episode | None, folder: Path) -> Row:
    """Return the appearance of a scene and the outcome of every action."""
    names = {actor.id: words.plain(actor.asset) for actor in scene.actors} if scene else {}
    return {
        "map": words.plain(scene.map) if scene else "",
        "weather": conditions(scene.weather) if scene else [],
        "setting": _setting(scene),
        "badWeather": scene is not None and scene.hazard.weather is not None,
        "players": _players(scene),
        "hazards": sorted(scene.hazard.actors) if scene else [],
        "decision": _decision(scene, episode, names),
        "choice": choice(episode) if episode else "",
        "frames": _frames(episode, folder),
        "actions": _outcomes(episode, names),
        "sketch": _sketch(episode.sketch, names) if episode and episode.sketch else None,
        "followed": bool(episode and episode.followers),
        "facts": _facts(episode, names),
    }


def _frames(episode: Episode | None, folder: Path) -> list[Row]:
    if episode is None or episode.status == "failed":
        return []
    times = episode.frame_times_s
    rows = []
    for moment in in_order(episode.frames or MOMENTS):
        found = picture(folder, episode.frames.get(moment))
        caption = f"{moment} · {times[moment]:.1f} s" if moment in times else moment
        rows.append(
            {"moment": moment, "caption": caption, "href": found.href, "problem": found.problem}
        )
    return rows


def _outcomes(episode: Episode | None, names: Mapping[str, str]) -> list[Row]:
    if episode is None:
        return []
    outcomes = dict(sorted(episode.actions.items(), key=lambda item: _rank(item[0])))
    return [
        {
            "id": action,
            "name": words.plain(action),
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
        "ends": {action: {name: list(end) for name, end in found.items()} for action, found in sketch.ends.items()},
    }  # fmt: skip


def _answer(verdict: Verdict, model: int) -> Row:
    """Return the answers of one answerer about one item; those of references are abridged."""
    row: Row = {
        "model": model,
        "outcome": _outcome(verdict),
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


def _outcome(verdict: Verdict) -> str:
    if verdict.status == "failed" and verdict.outcome == "answered":
        return "error"
    return verdict.outcome


def _cut(text: str) -> str:
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]} … ({len(text):,} characters)"


def _scores(found: Material) -> dict[str, tuple[float, str]]:
    """Return OOD-ness and nearest ordinary text by scenario, if scores and texts match."""
    report = found.metrics and found.metrics.sets.get("simulatable")
    if not report or len(report.oodness.per_text) != len(found.scenarios):
        return {}
    own = zip(found.scenarios, report.oodness.per_text, report.oodness.nearest, strict=True)
    return {scenario.id: (value, near.text) for scenario, value, near in own}


def _state(
    scene: Scene | None,
    episode: Episode | None,
    score: float | None,
    band: tuple[float, float] | None,
) -> str:
    if scene is None:
        if band and score is not None and not band[0] <= score <= band[1]:
            low, high = map(signed, band)
            return f"Not staged: its OOD-ness lies outside the band from {low} to {high}."
        return "Not staged yet."
    return "Not simulated yet." if episode is None else ""


def _band(config: Mapping[str, Any]) -> tuple[float, float] | None:
    bounds = config.get("band")
    if not isinstance(bounds, list) or len(bounds) != 2:
        return None
    low, high = number(bounds[0]), number(bounds[1])
    return None if low is None or high is None else (low, high)


def _setting(scene: Scene | None) -> str:
    if scene is None:
        return ""
    parts = [words.plain(scene.map)]
    parts += words.map_faults(scene.map_state) if scene.map_state else []
    parts += [words.weather(scene.weather), f"ego at {words.speed(scene.ego.speed)}"]
    return " · ".join(parts)


def _players(scene: Scene | None) -> list[Row]:
    if scene is None:
        return []
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


def _decision(scene: Scene | None, episode: Episode | None, names: Mapping[str, str]) -> str:
    if scene is None:
        return ""
    if scene.is_ordinary:
        return f"The ego must choose at {scene.decision.value:.1f} s, as in the scene."
    target = scene.decision.actor
    named = scene.decision.model_copy(
        update={"actor": f"the {names.get(target, target)}" if target else None}
    )
    when = words.trigger(named, "the ego", "the hazard")
    if episode is None or episode.decision_s is None:
        return f"The ego must choose {when}."
    if not episode.decision_fired:
        return f"The ego must choose {when}; that never came about, so the end of the approach at {episode.decision_s:.1f} s was taken."
    return f"The ego must choose {when}: at {episode.decision_s:.1f} s."


def _facts(episode: Episode | None, names: Mapping[str, str]) -> list[list[str]]:
    """Return the facts about a run that were noted, each with its name."""
    if episode is None:
        return []
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
    if (look := episode.sighting) is None:
        return ""
    name = names.get(look.actor, words.plain(look.actor))
    faults = f"; not judged, since it is {' and '.join(look.faults)}" if look.faults else ""
    return f"{name}, {look.height_px:g} pixels high in a picture of 480 rows, {look.distance_m:g} m away{faults}"


def _followers(episode: Episode, names: Mapping[str, str]) -> str:
    listed = ", ".join(names.get(name, words.plain(name)) for name in episode.followers)
    near = episode.follower
    if not listed or near is None:
        return listed
    return f"{listed}; the nearest {near.gap_m:.1f} m behind at {near.speed_mps:.1f} m/s"


def _reactions(episode: Episode) -> str:
    if not episode.reaction_s:
        return ""
    times = ", ".join(f"{one:g}" for one in episode.reaction_s)
    watched = "" if episode.horizon_s is None else f", each watched for {episode.horizon_s:g} s"
    return f"they react after {times} s{watched}"


def _seen(episode: Episode, names: Mapping[str, str]) -> str:
    last = sorted(episode.visible.get("last", {}).items(), key=lambda item: (-item[1], item[0]))
    return ", ".join(
        f"{names.get(name, words.plain(name))} {pixels} pixels" for name, pixels in last
    )
