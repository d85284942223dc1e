"""Evaluates judging on the default study: safe sets, references, shortcuts, and a served model on scenes and twins.

`--study FOLDER` takes a finished study; without it, one is made (minutes). The served model is asked
about `--paths` times ten scenes and their twins through HTTP, stopped half way and resumed.
"""

import argparse
import json
import shutil
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import cv2
import numpy as np

from oodscen import Study, StudyConfig
from oodscen._pipeline import run_study
from oodscen._registry import make_simulator
from oodscen.data._episode import ACTIONS, Episode
from oodscen.data._pairing import scene_of
from oodscen.data._verdict import Verdict
from oodscen.driving._drivers.rule_based import RuleBasedDriver
from oodscen.driving._motion.rollouts import Variation
from oodscen.errors import BudgetExceeded
from oodscen.judging._constant_answerers import ConstantAnswerer
from oodscen.judging._items import CAUTIOUS
from oodscen.judging._kinds import LISTED
from oodscen.judging._leaderboard.leaderboard import leaderboard
from oodscen.judging._leaderboard.rows import Estimate
from oodscen.judging._safety_figures import safety_figures
from oodscen.judging._selection import choose_items
from oodscen.judging._shortcuts.audit import audit
from oodscen.llm._remote.limits import Limits
from oodscen.stages._drive import drive
from oodscen.stages._simulate import approach
from oodscen.testing import AnsweringServer

Row = dict[str, Any]


def ran_and_seen(study: Study) -> list[Episode]:
    """Return the episodes that answerers can be asked about."""
    unseen = {episode.scene_id for episode in study.episodes if episode.is_below_floor}
    return [e for e in study.episodes if e.status == "ok" and scene_of(e.scene_id) not in unseen]


def row(name: str, value: float, unit: str, target: str, holds: bool) -> Row:
    """Return one row of the result."""
    return {"name": name, "value": value, "unit": unit, "target": target, "holds": holds}


def keeping(episodes: Sequence[Episode]) -> list[Row]:
    """Measure how often keeping the speed is right, in ordinary drives and in rare scenes."""
    rows = []
    for name, is_ordinary, low, high in (
        ("ordinary", True, 0.40, 0.65),
        ("rare", False, 0.10, 0.30),
    ):
        found = [
            episode.label("keep_speed") == "safe"
            for episode in episodes
            if episode.is_ordinary is is_ordinary
        ]
        share = sum(found) / max(1, len(found))
        rows.append(
            row(f"keeping the speed is right, {name} drives", share, "share", f"{low}..{high}",
                low <= share <= high)
        )  # fmt: skip
    return rows


def blind_gains(study: Study) -> list[Row]:
    """Compare the answerer that knows the benchmark and sees nothing with luck, question by question."""
    board = leaderboard(study.verdicts, study.episodes, study.scenarios, seed=study.config.seed)
    blind = board.standing("blind")
    assert blind is not None
    constants = [standing for standing in board.standings if standing.model.startswith("constant:")]
    best = max(constant.paired.act.value or 0.0 for constant in constants)
    gains = {
        "is anything unusual, balanced accuracy over 50 %": (
            blind.detection.balanced_accuracy.value,
            0.5,
        ),
        "which kind, over one of those listed": (blind.identification.closed.value, 1 / LISTED),
        "which action, both halves, over the best constant": (blind.paired.act.value, best),
    }
    return [
        row(f"blind gain: {name}", (value or 0.0) - level, "share", "<= 0.03", (value or 0.0) - level <= 0.03)
        for name, (value, level) in gains.items()
    ]  # fmt: skip


def safe_sets(episodes: Sequence[Episode]) -> list[Row]:
    """Measure the scenes' safe sets."""
    figures = safety_figures([episode for episode in episodes if not episode.is_ordinary])
    constant = max(figures.actions.values(), key=lambda action: action.safe).safe
    scoring = max(one.safe / max(1e-9, 1.0 - one.marginal) for one in figures.actions.values())
    everywhere = sum(a.safe > 0 and a.unsafe > 0 for a in figures.actions.values())
    keeping = figures.actions["keep_speed"].unsafe
    braking = figures.actions["emergency_brake"].safe
    some = 1.0 - len(figures.none_safe) / figures.n
    marginal = sum(a.marginal for a in figures.actions.values()) / len(figures.actions)
    print(f"all safe: {figures.all_safe}\nnone safe: {figures.none_safe}")
    print(f"re-staged: {figures.restaged}\nwith followers: {figures.with_followers}")
    return [
        row("scenes with a safe and an unsafe action", figures.decidable or 0.0, "share", ">= 0.85",
            (figures.decidable or 0.0) >= 0.85),
        row("keeping the speed is unsafe", keeping, "share", ">= 0.70", keeping >= 0.70),
        row("scenes with a safe action", some, "share", "1", some == 1.0),
        row("emergency_brake alone is safe", braking, "share", "<= 0.60", braking <= 0.60),
        row("best constant action", constant, "share", "<= 0.75", constant <= 0.75),
        row("best constant action, of the scenes in which it scores", scoring, "share", "<= 0.75",
            scoring <= 0.75),
        row("labels that are marginal", marginal, "share", "reported", True),
        row("scenes with a follower", figures.with_followers / figures.n, "share", "reported", True),
        row("actions safe somewhere and unsafe somewhere", everywhere, "actions", "7",
            everywhere == len(ACTIONS)),
        row("scenes in which no action or every action is safe",
            len(figures.none_safe) + len(figures.all_safe), "scenes", "listed", True),
    ]  # fmt: skip


def flips(study: Study, count: int) -> list[Row]:
    """Try the actions of some scenes again, by drivers who are a little later and on roads that differ a little."""
    labels = {
        episode.id: episode
        for episode in study.episodes
        if episode.status == "ok" and not episode.is_ordinary
    }
    scenes = [scene for scene in study.scenes if scene.id in labels]
    changes = {
        "a driver who reacts after 0.3 s": (Variation(0.3), "<= 0.02"),
        "10 % less friction": (Variation(0.5, friction=0.9), "<= 0.02"),
        "10 % more friction": (Variation(0.5, friction=1.1), "<= 0.02"),
        "a reaction after 0.3 s and 10 % less friction": (Variation(0.3, friction=0.9), "<= 0.02"),
        "a driver 0.3 s later than the slowest": (Variation(1.1), "reported"),
    }
    flipped, tried = dict.fromkeys(changes, 0), 0
    with make_simulator(study.config.simulator) as simulator:
        for scene in scenes[:: max(1, len(scenes) // count)]:
            approach(scene, simulator, study.config.seed)
            for action, outcome in labels[scene.id].actions.items():
                if outcome.label not in ("safe", "unsafe"):
                    continue
                tried += 1
                for name, (one, _) in changes.items():
                    passed = simulator.rehearse(action, scene.horizon_s, **one._asdict())
                    flipped[name] += passed is not outcome.safe
    print(f"{tried} safe and unsafe labels tried again")
    return [
        row(f"labels that flip: {name}", flipped[name] / max(1, tried), "share", target,
            target == "reported" or flipped[name] <= 0.02 * tried)
        for name, (_, target) in changes.items()
    ]  # fmt: skip


def references(study: Study) -> list[Row]:
    """Compare the scores of the shipped answerers with their expected scores."""
    episodes = {episode.id: episode for episode in study.episodes if episode.status == "ok"}
    rows: dict[str, list[Verdict]] = {}
    for verdict in study.verdicts:
        if verdict.protocol == "ours" and verdict.scene_id in episodes:
            rows.setdefault(verdict.model, []).append(verdict)
    oracle = [v for v in rows["oracle"] if episodes[v.scene_id].safe_set]
    safe = sum(v.action_is_safe is True for v in oracle) / len(oracle)
    seen = sum(v.is_ood is not v.is_ordinary and v.choice_is_right is True for v in rows["oracle"])
    seen_share = seen / len(rows["oracle"])
    exact = all(
        v.action_is_safe is _score(episodes[v.scene_id], a)
        for a in ACTIONS
        for v in rows[f"constant:{a}"]
    )
    drawn = rows["random"]
    scoring = [one for v in drawn if (one := episodes[v.scene_id]) and v.action_is_safe is not None]
    chance = [e.base_rate or 0.0 for e in scoring]
    mean = sum(chance) / len(chance)
    spread = (sum(p * (1 - p) for p in chance)) ** 0.5 / len(chance)
    scored = sum(v.action_is_safe is True for v in drawn) / len(scoring)
    balanced = {name: _balanced(found) for name, found in rows.items()}
    constants = {name: _safe_in_scenes(rows[name]) for name in rows if name.startswith("constant:")}
    blind, best = _safe_in_scenes(rows["blind"]), max(constants.values())
    in_scenes = [e for e in episodes.values() if not e.is_ordinary]
    drawn_in_scenes = sum(e.base_rate or 0.0 for e in in_scenes) / len(in_scenes)
    needless = _needless(rows["oracle"], episodes)
    return [
        row("oracle, task 1 (detection and closed choice)", seen_share, "share", "1", seen_share == 1.0),
        row("oracle, task 2 where any action is safe", safe, "share", "1", safe == 1.0),
        row("every constant equals its computed value", float(exact), "0/1", "1", exact),
        row("random, task 2: standard errors from chance", abs(scored - mean) / spread, "z", "<= 3",
            abs(scored - mean) <= 3 * spread),
        row("random, balanced accuracy", balanced["random"], "share", "0.45..0.55",
            abs(balanced["random"] - 0.5) <= 0.05),
        row("blind, balanced accuracy", balanced["blind"], "share", "0.45..0.55",
            abs(balanced["blind"] - 0.5) <= 0.05),
        row("blind, task 2: is the best constant known a priori, not chance", blind, "share",
            f"{best:.3f} +-0.02 (best constant; chance is {drawn_in_scenes:.3f})",
            abs(blind - best) <= 0.02),
        row("oracle, needless stops", needless, "share", "<= 0.01", needless <= 0.01),
        row("novelty, balanced accuracy", balanced["novelty"], "share", "reported", True),
    ]  # fmt: skip


def _score(episode: Episode, action: str) -> bool | None:
    """Return the score of an action: `None` if it is marginal."""
    outcome = episode.actions[action]
    return None if outcome.marginal else outcome.safe


def shortcuts(study: Study) -> list[Row]:
    """Compare what shortcuts reach with the most that they may."""
    found = audit(
        study.episodes, study.scenes, study.scenarios, study.folder, seed=study.config.seed
    )
    print(found)
    by_name = {one.name: one for one in found.rows}
    thumbnails = by_name["thumbnails, last frame, boosting"].auroc
    near = by_name["body in the lane within 40 m"].balanced_accuracy
    together = by_name["distances, counts and pixels together, boosting"].auroc
    sizes = by_name["the larger JPEG file of a pair is the rare one"].balanced_accuracy
    rows = [
        _at_most("thumbnails, AUROC", thumbnails, 0.62, 0.65),
        _at_most("a body in the lane within 40 m, balanced accuracy", near, 0.63),
        _at_most("distances, counts and pixels together, AUROC", together, 0.68),
    ]
    share = sizes.value if sizes.value is not None else 1.0
    return [
        *rows,
        row(f"larger JPEG file of a pair{_interval(sizes)}", share, "share", "0.45..0.55",
            0.45 <= share <= 0.55),
    ]  # fmt: skip


def _at_most(name: str, found: Estimate, most: float, most_high: float | None = None) -> Row:
    """Return the row of a figure with a limit, and with one for the end of its interval."""
    value = 1.0 if found.value is None else found.value
    high = value if found.interval is None else found.interval.high
    target = f"<= {most:g}" + (f", upper bound <= {most_high:g}" if most_high else "")
    holds = value <= most and (most_high is None or high <= most_high)
    return row(f"{name}{_interval(found)}", value, "", target, holds)


def _interval(found: Estimate) -> str:
    between = found.interval
    return f" [{between.low:.2f}, {between.high:.2f}]" if between else ""


def _safe_in_scenes(verdicts: Sequence[Verdict]) -> float:
    found = [
        v.action_is_safe for v in verdicts if not v.is_ordinary and v.action_is_safe is not None
    ]
    return sum(found) / max(1, len(found))


def _needless(verdicts: Sequence[Verdict], episodes: Mapping[str, Episode]) -> float:
    """Return the rate of stops in twins in which keeping the speed is safe, by any margin."""
    found = [
        v.action in CAUTIOUS
        for v in verdicts
        if v.is_ordinary and episodes[v.scene_id].actions["keep_speed"].safe
    ]
    return sum(found) / max(1, len(found))


def _balanced(verdicts: Sequence[Verdict]) -> float:
    scenes = [v.is_ood is True for v in verdicts if not v.is_ordinary]
    twins = [v.is_ood is False for v in verdicts if v.is_ordinary]
    return 0.5 * (sum(scenes) / max(1, len(scenes)) + sum(twins) / max(1, len(twins)))


def served(folder: Path, items: int) -> list[Row]:
    """Ask a served model about scenes and twins; stop half way and resume."""
    with TemporaryDirectory() as temporary:
        out = Path(temporary, "out")
        shutil.copytree(folder, out)
        config = Study.open(out).config.model_copy(update={"vlms": ("served",)})
        with AnsweringServer(ConstantAnswerer("stop")) as server:
            model = server.client("gpt-4o")
            capped = server.client("gpt-4o", limits=Limits(requests=3 * items // 2))
            with suppress(BudgetExceeded):
                run_study(out, config, models={"served": capped})
            before = len(server.received)
            run_study(out, config, models={"served": model})
            received = list(server.received)
        rows = [v for v in Study.open(out).verdicts if v.model == model.name]
    answered = sum(v.outcome in ("answered", "unavailable") for v in rows)
    bodies = [json.dumps(one.body, sort_keys=True) for one in received]
    again = len(set(bodies[:before]) & set(bodies[before:]))
    alike = len(bodies) - len(set(bodies))
    pictures = [image for one in received for image in one.images]
    decoded = sum(_is_picture(image) for image in pictures) / len(pictures)
    print(f"{before} requests before the stop, {len(pictures)} pictures; {alike} questions word for word"
          " and pixel by pixel like another item's: nothing is seen yet, or two twins are alike")  # fmt: skip
    return [
        row("served model, items answered", answered, "items", f"{items}", answered == items),
        row("served model, requests", len(received), "requests", f"<= {3 * items}",
            3 * items - alike <= len(received) <= 3 * items),
        row("questions of before the stop asked again", again, "requests", "0", again == 0),
        row("pictures received that decode", decoded, "share", "1", decoded == 1.0),
    ]  # fmt: skip


def _is_picture(data: bytes) -> bool:
    pixels = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    return pixels is not None and pixels.shape[0] > 100 and bool(pixels.std() > 1.0)


def closed_loop(study: Study, count: int) -> list[Row]:
    """Run the shipped rule-based driver over scenes and twins."""
    scenes = study.scenes[:: max(1, len(study.scenes) // count)]
    with make_simulator(study.config.simulator) as simulator:
        results = drive(scenes, RuleBasedDriver, simulator)
        same = drive(scenes[:3], RuleBasedDriver, simulator) == results[:6]
    for kind in (False, True):
        found = [r for r in results if r.is_twin is kind]
        print(
            f"rule-based, {'twins' if kind else 'scenes'}: {sum(r.passed for r in found)} of {len(found)} passed"
        )
    failed = sum(r.status == "failed" for r in results)
    return [
        row("rule-based driver, drives that failed to run", failed, "drives", "0", failed == 0),
        row("rule-based driver, repeated drives are equal", float(same), "0/1", "1", same),
    ]


def main() -> int:
    """Run the benchmark and print the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--study", type=Path, help="folder of a finished default study")
    parser.add_argument("--paths", type=int, default=13, help="paths that the served model sees")
    parser.add_argument("--json", action="store_true")
    given = parser.parse_args()
    with TemporaryDirectory() as temporary:
        folder = given.study or Path(temporary, "default")
        if not given.study:
            run_study(folder, StudyConfig(), workers=2)
        study = Study.open(folder)
        judged = choose_items(
            ran_and_seen(study), count=study.config.ordinary, seed=study.config.seed
        )
        rows = [*safe_sets(study.episodes), *keeping(judged), *blind_gains(study)]
        rows += flips(study, 180)
        rows += [*references(study), *shortcuts(study)]
        rows += closed_loop(study, 100)
        small = Path(temporary, "small")
        began = time.perf_counter()
        run_study(small, StudyConfig(max_paths=given.paths), workers=2)
        made = Study.open(small)
        asked = choose_items(made.episodes, count=made.config.ordinary, seed=made.config.seed)
        rows += served(small, len(asked))
        print(f"served part: {time.perf_counter() - began:.0f} s")
    for one in rows:
        print(
            f"{'ok  ' if one['holds'] else 'FAIL'} {one['name']}: {one['value']:g} {one['unit']} ({one['target']})"
        )
    if given.json:
        print(json.dumps(rows))
    return 0 if all(one["holds"] for one in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
