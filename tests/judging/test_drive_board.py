"""What drives come to: counts that add up, pairs, and no prize for standing still."""

from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen.data._drive_result import DriveResult
from oodscen.judging._drive_board import (
    HARDLY_DRIVES,
    RULE_BASED,
    current_results,
    drive_board,
)
from oodscen.testing._scenes import example_scene


def drives(driver, outcomes, progress=1.0):
    """Two results per (passed in the scene, passed in the twin), or their status if it is not `ok`."""
    found = []
    for index, pair in enumerate(outcomes):
        for suffix, passed in zip(("", "~twin"), pair, strict=True):
            name = f"leaf-{index % 6}-{index:03d}{suffix}"
            found.append(
                DriveResult(
                    id=f"{name}@{driver}",
                    scene_id=name,
                    driver=driver,
                    is_twin=bool(suffix),
                    status=passed if isinstance(passed, str) else "ok",
                    passed=passed is True,
                    collisions=("box",) if passed is False else (),
                    min_ttc_s=1.0 if passed is False else None,
                    progress=progress,
                    progress_lost=0.0,
                    peak_deceleration=3.0,
                )
            )
    return found


PAIRS = st.lists(
    st.tuples(*[st.sampled_from([True, False, "failed", "inconclusive"])] * 2),
    min_size=1,
    max_size=14,
)


@settings(max_examples=20, deadline=None)
@given(PAIRS)
def test_counts_add_up(outcomes):
    board = drive_board(drives("mine", outcomes))
    scenes, pair = board.of("mine"), board.of("mine").paired
    lost = scenes.failed + scenes.inconclusive
    assert scenes.n == lost + scenes.passed + scenes.collisions == len(outcomes)
    assert scenes.inconclusive == sum(first == "inconclusive" for first, _ in outcomes)
    assert pair.n == pair.both + pair.scene_only + pair.twin_only + pair.neither
    assert pair.drives_and_passes.hits == pair.both == outcomes.count((True, True))
    assert scenes.shares["critical"].hits == scenes.collisions
    assert scenes.means["progress"].n == scenes.n - lost
    share = scenes.shares["passed"]
    if share.n:
        assert share.interval.low <= share.value <= share.interval.high


@settings(max_examples=20, deadline=None)
@given(PAIRS, PAIRS)
def test_the_last_result_in_a_scene_counts(earlier, later):
    replaced = drives("mine", earlier[: len(later)])
    last = drives("mine", later)
    assert drive_board(replaced + last) == drive_board(last)


BRAKED = st.sampled_from([True, False, None, "failed"])


@given(st.lists(BRAKED, min_size=1, max_size=12))
def test_needless_braking_is_a_share_of_the_twins_in_which_it_was_looked_for(braked):
    found = drives("mine", [(True, one if one == "failed" else True) for one in braked])
    for index, one in enumerate(braked):
        known = {"brakes_needlessly": None if one == "failed" else one}
        found[2 * index : 2 * index + 2] = [
            drive.model_copy(update=known) for drive in found[2 * index : 2 * index + 2]
        ]
    board = drive_board(found)
    share = board.of("mine", "twins").shares["needless"]
    assert (share.hits, share.n) == (braked.count(True), braked.count(True) + braked.count(False))
    assert "needless" not in board.of("mine").shares


def test_needless_braking_that_nobody_looked_for_is_not_spoken_of():
    found = [
        drive.model_copy(update={"brakes_needlessly": None})
        for drive in drives("mine", [(True, True)])
    ]
    (said,) = drive_board(found).sentences()
    assert "drives and passes" in said
    assert "without need" not in said


def test_who_stands_still_passes_every_scene_and_ranks_last():
    outcomes = [(True, True)] * 12
    ruled = drives(RULE_BASED, [*outcomes[1:], (False, True)])
    board = drive_board([*drives("still", outcomes, HARDLY_DRIVES / 5), *ruled])
    assert board.drivers == (RULE_BASED, "still")
    assert board.of("still").passed > board.of(RULE_BASED).passed
    assert board.of("still").paired.drives_and_passes.hits == 0
    test = board.of("still").paired.against_rule_based
    assert test.difference < -0.9
    assert test.p_clustered < 0.05
    (said,) = board.remarks()
    assert "still passes 100\N{NO-BREAK SPACE}% of the scenes by hardly driving" in said


def test_without_paths_enough_means_have_no_interval_and_shares_have_wilsons():
    board = drive_board(drives("mine", [(True, False), (False, True)]))
    assert board.of("mine").means["progress"].interval is None
    assert board.of("mine").shares["passed"].interval.method == "wilson"
    assert not drive_board([]).rows


@given(st.lists(st.booleans(), min_size=1, max_size=6), st.randoms(use_true_random=False))
def test_results_are_kept_in_the_order_of_the_scenes_while_these_stay_as_they_are(moved, rng):
    scenes = [example_scene().model_copy(update={"id": f"leaf-{n}"}) for n in range(len(moved))]
    results = [
        DriveResult(
            id=f"{scene.id}{twin}@{driver}",
            scene_id=f"{scene.id}{twin}",
            driver=driver,
            is_twin=bool(twin),
            made_from=scene.digest(),
        )
        for driver in ("a", "b")
        for scene in scenes
        for twin in ("", "~twin")
    ]
    now = [
        scene.model_copy(update={"horizon_s": 3.0 if is_moved else scene.horizon_s})
        for scene, is_moved in zip(scenes, moved, strict=True)
    ]
    kept = {scene.id for scene, is_moved in zip(scenes, moved, strict=True) if not is_moved}
    wanted = [result for result in results if result.scene_id.removesuffix("~twin") in kept]
    assert current_results(rng.sample(results, len(results)), now) == wanted
