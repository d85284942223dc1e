"""Safe sets: repeatable, whatever the order; best action; chance; re-staging."""

from math import inf

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from oodscen import make_simulator, simulate
from oodscen.data._episode import (
    ACTIONS,
    INTERVENTIONS,
    ActionOutcome,
    Episode,
    base_rate,
    best_action,
    has_enough_margin,
)
from oodscen.data._scene import Actor, Behaviour, Ego, Hazard, Placement, Scene, Trigger
from oodscen.data._weather import Weather
from oodscen.driving._sight.placement import check_scene
from oodscen.judging._safety_figures import safety_figures
from oodscen.protocols import Camera
from oodscen.stages._restaging.rerun import Rerunner
from oodscen.stages._restaging.restage import restage, variants
from oodscen.testing._scenes import example_scene

OUTCOMES = st.builds(
    ActionOutcome,
    safe=st.booleans(),
    margin_m=st.none() | st.floats(0, 50),
    min_ttc_s=st.none() | st.floats(0, 5),
    peak_deceleration=st.none() | st.floats(0, 9),
) | st.just(ActionOutcome(safe=False, unavailable=True))

SMALL = Camera(width=160, height=120)
few = settings(max_examples=6, suppress_health_check=list(HealthCheck))

KINDS = (
    ("cardboard_box", "stand"),
    ("car", "stand"),
    ("van", "reverse"),
    ("adult", "cross_road"),
    ("adult", "bolt"),
)
"""Assets with what they do: nothing that reacts to others, so that a hazard acts on them by touching only."""


@pytest.fixture(scope="module")
def simulator():
    with make_simulator("flat") as made:
        yield made


@given(st.dictionaries(st.sampled_from(ACTIONS), OUTCOMES))
def test_the_choice_matters_where_a_safe_action_and_an_unsafe_one_can_be_executed(outcomes):
    run = Episode(id="a", scene_id="a", status="ok", actions=outcomes)
    executed = {outcome.safe for outcome in outcomes.values() if not outcome.unavailable}
    assert run.is_decidable == (executed == {True, False})


@given(st.dictionaries(st.sampled_from(ACTIONS), OUTCOMES))
def test_the_best_action_is_safe_and_chance_is_the_share_of_safe_ones(outcomes):
    best = best_action(outcomes)
    safe = [name for name, outcome in outcomes.items() if outcome.safe]
    assert (best in safe) if safe else best is None
    assert base_rate(outcomes) == (len(safe) / len(outcomes) if outcomes else None)


@given(st.dictionaries(st.sampled_from(ACTIONS), OUTCOMES))
def test_the_best_action_interferes_no_more_than_enough_margin_asks_for(outcomes):
    best = best_action(outcomes)
    enough = [name for name, outcome in outcomes.items() if has_enough_margin(outcome)]
    if enough:
        least = min(enough, key=INTERVENTIONS.index)
        lanes = {"change_lane_left", "change_lane_right"}
        assert {best, least} <= lanes or best == least
    elif best is not None:
        gaps = [inf if o.margin_m is None else o.margin_m for o in outcomes.values() if o.safe]
        mine = outcomes[best].margin_m
        assert (inf if mine is None else mine) == max(gaps)


@pytest.mark.parametrize(
    ("left", "right", "best"),
    [
        (1.3, 1.2, "left"),
        (1.2, 1.3, "right"),
        (1.2, 1.2, "right"),
        (1.3, 0.6, "left"),
        (None, 9.0, "left"),
    ],
)
def test_of_both_changes_of_lane_the_one_with_the_larger_gap_is_best(left, right, best):
    outcomes = {
        "change_lane_left": ActionOutcome(safe=True, margin_m=left, peak_deceleration=0.1),
        "change_lane_right": ActionOutcome(safe=True, margin_m=right),
        "stop": ActionOutcome(safe=True, margin_m=5.0),
    }
    assert best_action(outcomes) == f"change_lane_{best}"


def test_actions_that_nobody_knows_are_ranked_in_a_fixed_order():
    unknown = {name: ActionOutcome(safe=True, margin_m=1.0) for name in ("wave", "honk", "flash")}
    assert best_action(unknown) == best_action(dict(reversed(unknown.items()))) == "flash"


def test_the_safe_set_does_not_depend_on_the_order_of_rollouts(simulator):
    first = simulate(example_scene(), simulator, render=False).episode
    again = simulate(example_scene(), simulator, render=False, actions=ACTIONS[::-1]).episode
    alone = simulate(example_scene(), simulator, render=False, actions=("stop",)).episode
    assert first.actions == again.actions
    assert alone.actions["stop"] == first.actions["stop"]
    assert first.actions["emergency_brake"].peak_deceleration > 7
    assert first.actions["keep_speed"].peak_deceleration == 0


def actors(name, slot):
    return st.builds(
        lambda kind, begin, **placed: Actor(
            id=name,
            asset=kind[0],
            placement=Placement(**placed),
            behaviour=Behaviour(name=kind[1], trigger=Trigger(kind="time", value=begin)),
        ),
        kind=st.sampled_from(KINDS),
        begin=st.sampled_from([0.0, 0.5, 2.0]),
        ahead_m=st.integers(25 + 30 * slot, 45 + 30 * slot).map(float),
        lane=st.sampled_from([0, 1]),
        offset_m=st.sampled_from([-0.5, 0.0, 0.5]),
        heading_deg=st.sampled_from([0.0, 15.0]),
    )


@st.composite
def scenes(draw):
    cast = [draw(actors(name, slot)) for slot, name in enumerate("abc")]
    hazard = {"a": draw(st.none() | actors("a", 0))}
    clear = draw(st.sampled_from([None, Weather()]))
    return Scene(
        id="drawn-001",
        scenario_id="drawn-001",
        map="residential_two_lane",
        ego=Ego(speed=draw(st.sampled_from([4.0, 8.0, 12.0]))),
        weather=Weather(friction=0.4, fog_visual_range_m=80.0) if clear else Weather(),
        actors=tuple(draw(st.permutations(cast))),
        hazard=Hazard(actors=hazard, weather=clear),
        decision=Trigger(kind="time", value=draw(st.sampled_from([0.5, 1.0, 2.0]))),
        horizon_s=2.0,
    )


def staged(scene, simulator):
    both = (scene, scene.twin(1.0))
    assume(not any(check_scene(one, simulator.catalogue()) for one in both))
    return scene


@few
@given(scenes(), st.permutations(ACTIONS), st.integers(1, len(ACTIONS)))
def test_rollouts_are_the_same_bytes_again_in_any_order_and_number(simulator, scene, order, count):
    scene = staged(scene, simulator)
    first = simulate(scene, simulator, render=False).episode
    part = simulate(scene, simulator, render=False, actions=order[:count]).episode
    whole = simulate(scene, simulator, render=False, actions=order).episode
    assert first.is_deterministic
    assert first.trace_sha256 == part.trace_sha256 == whole.trace_sha256
    assert whole.actions == first.actions
    assert set(whole.safe_set) == set(first.safe_set)
    for name in order[:count]:
        assert part.actions[name].to_json() == first.actions[name].to_json()


@few
@given(scenes())
def test_a_twin_starts_alike_and_moves_alike_until_the_hazard_acts(simulator, scene):
    scene = staged(scene, simulator)
    run = simulate(scene, simulator, render=False, actions=())
    twin = simulate(scene.twin(run.episode.decision_s), simulator, render=False, actions=())
    shared = ["ego", "b", "c"]

    def rows(state):
        ids = [state.ids.index(name) for name in shared]
        return state.poses[ids].tobytes(), state.speeds[ids].tobytes()

    assert rows(run.states[0]) == rows(twin.states[0])
    assert set(twin.states[0].ids) == {"ego", *(actor.id for actor in scene.twin(1.0).actors)}
    if scene.hazard.weather is None:
        for here, there in zip(run.states, twin.states, strict=False):
            assert rows(here) == rows(there)
        if not run.states[-1].contacts and not twin.states[-1].contacts:
            assert run.episode.decision_s == twin.episode.decision_s


@few
@given(scenes())
def test_a_hazard_that_is_its_own_counterpart_changes_nothing(simulator, scene):
    actor = next(one for one in scene.actors if one.id == "a")
    same = scene.model_copy(update={"hazard": Hazard(actors={"a": actor}), "weather": Weather()})
    scene = staged(same, simulator)
    run = simulate(scene, simulator, render=False).episode
    twin = simulate(scene.twin(run.decision_s), simulator, render=False).episode
    assert twin.trace_sha256 == run.trace_sha256
    assert twin.actions == run.actions


def test_the_papers_protocol_shows_the_whole_trace_and_counts_collisions_only(simulator):
    ours = simulate(example_scene(), simulator, camera=SMALL)
    paper = simulate(example_scene(), simulator, camera=SMALL, protocol="paper")
    assert len(paper.states) > len(ours.states)
    assert paper.episode.frame_sha256["first"] == ours.episode.frame_sha256["first"]
    assert paper.episode.frame_sha256["last"] != ours.episode.frame_sha256["last"]
    assert paper.episode.decision_s == ours.episode.decision_s
    assert paper.episode.trace_sha256 == ours.episode.trace_sha256
    for outcome in paper.episode.actions.values():
        assert outcome.safe is (not outcome.contacts and not outcome.unavailable)


def test_a_scene_that_tells_actions_apart_is_left_and_variants_differ(simulator):
    scene = example_scene()
    run = simulate(scene, simulator, render=False)
    assert run.episode.is_decidable
    for easy in (True, False):
        changed = list(variants(scene, simulator.catalogue(), is_too_easy=easy))
        assert len({how for _, how in changed}) == len(changed) >= 6
        assert all(one != scene and one.id == scene.id for one, _ in changed)


def test_a_scene_without_danger_is_restaged_or_left_as_it_was(simulator):
    scene = example_scene()
    box = scene.actors[0]
    aside = box.model_copy(update={"placement": box.placement.model_copy(update={"offset_m": 7.5})})
    easy = scene.model_copy(update={"actors": (aside, *scene.actors[1:])})
    run = simulate(easy, simulator, camera=SMALL)
    assert not run.episode.is_decidable
    changed, again, tried = restage(easy, run, Rerunner(simulator, camera=SMALL))
    assert again.episode.is_decidable is bool(again.episode.restaged)
    assert (changed is easy) is (not again.episode.restaged)
    all_variants = list(
        variants(easy, simulator.catalogue(), is_too_easy=bool(run.episode.safe_set))
    )
    assert [one.how for one in tried] == [how for _, how in all_variants][: len(tried)]
    assert all(one.why for one in tried)
    if changed is easy:
        assert len(tried) == len(all_variants)


def test_figures_list_what_tells_nothing():
    def episode(name, *safe):
        actions = {a: ActionOutcome(safe=a in safe) for a in ("stop", "keep_speed")}
        return Episode(id=name, scene_id=name, status="ok", actions=actions)

    found = safety_figures([episode("a", "stop"), episode("b", "stop", "keep_speed"), episode("c")])
    assert (found.n, found.all_safe, found.none_safe) == (3, ("b",), ("c",))
    assert found.decidable == pytest.approx(1 / 3)
    assert found.base_rate == pytest.approx(0.5)
    assert found.actions["stop"].safe == pytest.approx(2 / 3)
    assert safety_figures([]).n == 0


def test_an_episode_in_which_no_action_scores_does_not_lower_the_base_rate():
    marginal = {"stop": ActionOutcome(safe=False, marginal=True)}
    safe = {"stop": ActionOutcome(safe=True), "keep_speed": ActionOutcome(safe=False)}
    runs = [
        Episode(id=name, scene_id=name, status="ok", actions=actions)
        for name, actions in (("a", marginal), ("b", safe))
    ]
    assert safety_figures(runs).base_rate == 0.5
    assert safety_figures(runs[:1]).base_rate is None
