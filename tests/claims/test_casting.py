"""The things of a text are cast so that the fewest claims fail."""

from itertools import permutations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.claims._assignment import cheapest_assignment
from oodscen.claims._casting import Casting, Subject, cast
from oodscen.claims._findings import failures
from oodscen.claims._things import thing_named
from oodscen.data._claim import Claim
from tests.claims.observations import observed

PLACES = ("ahead", "behind", "left", "right")
SIDES = {"ahead": {"ahead_m": (9,)}, "behind": {"ahead_m": (-9,)}, "left": {"aside_m": (9,)}, "right": {"aside_m": (-9,)}}  # fmt: skip


def subject(name: str, values=("ahead",), candidates=(), **fields) -> Subject:
    claims = [Claim(kind="place", value=value, subject=name) for value in values]
    defaults = {"thing": None, "is_stated": False, "misfit": "", "is_of_map": False}
    fields = {**defaults, "map_fault": "", "is_scenery": False, **fields}
    return Subject(name=name, candidates=candidates, **{"claims": claims, **fields})


def failed(castings: dict[str, Casting]) -> int:
    return sum(failures(casting.findings.values()) for casting in castings.values())


@given(
    st.lists(st.sets(st.sampled_from(PLACES), min_size=1), min_size=1, max_size=3),
    st.lists(st.sampled_from(PLACES), min_size=1, max_size=4),
)
def test_no_other_cast_contradicts_fewer_claims(values, sides):
    actors = [observed(index=index, **SIDES[side]) for index, side in enumerate(sides)]
    names = [f"car {number}" for number in range(len(values))]
    together = cast([subject(name, told, actors) for name, told in zip(names, values, strict=True)])
    assert list(together) == names
    ids = [actor_id for casting in together.values() for actor_id in casting.actor_ids]
    assert len(ids) == len(set(ids)) == min(len(names), len(actors))
    if len(names) <= len(actors):
        alone = [
            sum(
                failed(cast([subject(name, told, [actor])]))
                for name, told, actor in zip(names, values, chosen, strict=False)
            )
            for chosen in permutations(actors, len(names))
        ]
        assert failed(together) == min(alone)


def test_things_find_their_actors_among_many():
    sides = ["behind"] * 10 + ["ahead"] * 10
    actors = [observed(index=index, **SIDES[side]) for index, side in enumerate(sides)]
    castings = cast([subject(f"car {number}", candidates=actors) for number in range(10)])
    assert failed(castings) == 0
    assert [casting.actor_ids for casting in castings.values()] == [[a.id] for a in actors[10:]]


COSTS = st.integers(0, 5).flatmap(
    lambda rows: st.integers(rows, 6).flatmap(
        lambda columns: st.lists(
            st.lists(st.sampled_from((0, 1, 2, 1000)), min_size=columns, max_size=columns),
            min_size=rows,
            max_size=rows,
        )
    )
)


@given(COSTS)
def test_the_cheapest_assignment_is_the_first_of_all_as_cheap(costs):
    columns = len(costs[0]) if costs else 0

    def total(chosen: tuple[int, ...]) -> int:
        return sum(line[column] for line, column in zip(costs, chosen, strict=True))

    assert tuple(cheapest_assignment(costs)) == min(
        permutations(range(columns), len(costs)), key=total
    )


def test_a_claim_about_several_holds_if_it_is_open_for_others():
    box, car = observed(asset="cardboard_box"), observed(index=1, state="hazard")
    claim = Claim(kind="state", value="hazard", subject="things")
    several = subject("things", candidates=[box, car], claims=[claim], is_stated=True)
    (casting,) = cast([several]).values()
    assert casting.findings[claim].status == "holds"


def test_a_thing_that_no_actor_fits_contradicts_all_its_claims():
    (without,) = cast([subject("whale", ("ahead", "left"))]).values()
    assert failed({"whale": without}) == 2
    assert without.actor_ids == ()
    found = {finding.found for finding in without.findings.values()}
    assert found == {"there is no actor that is one"}
    first, second = cast(
        [subject("car", candidates=[observed()]), subject("car 2", candidates=[observed()])]
    ).values()
    assert first.actor_ids == ["it-0"]
    (finding,) = second.findings.values()
    assert finding.found == "there is no other actor that is one"


def test_a_reason_why_nothing_fits_is_told_before_all_others():
    (without,) = cast([subject("whale", misfit="'dog' is a dog", is_of_map=True)]).values()
    assert {finding.found for finding in without.findings.values()} == {"'dog' is a dog"}
    (of_map,) = cast([subject("whale", is_of_map=True)]).values()
    assert "the road has none" in next(iter(of_map.findings.values())).found


def test_anyone_may_be_several_actors():
    someone = thing_named("someone")
    assert someone is not None
    assert someone.vague
    actors = [observed(index=index, **SIDES[side]) for index, side in enumerate(PLACES)]
    (casting,) = cast([subject("someone", PLACES, actors, thing=someone)]).values()
    assert failed({"someone": casting}) == 0
    assert len(casting.actor_ids) == len(actors)


def test_a_stated_group_is_judged_as_one():
    actors = [observed(index=index, **SIDES[side]) for index, side in enumerate(PLACES)]
    (casting,) = cast([subject("car", PLACES, actors, is_stated=True)]).values()
    assert failed({"car": casting}) == 0
    (single,) = cast([subject("car", PLACES, actors[:1], is_stated=True)]).values()
    assert failed({"car": single}) == 3


@pytest.mark.parametrize(("noun", "actor_ids"), [("bridge", ()), ("traffic light", ["it-0"])])
def test_the_map_shows_what_no_actor_shows_as_well_except_for_a_signal(noun, actor_ids):
    behind = observed(**SIDES["behind"])
    (casting,) = cast(
        [subject(noun, candidates=[behind], thing=thing_named(noun), is_scenery=True)]
    ).values()
    assert casting.actor_ids == actor_ids
    (ahead,) = cast(
        [subject(noun, candidates=[observed()], thing=thing_named(noun), is_scenery=True)]
    ).values()
    assert ahead.actor_ids == ["it-0"]


def test_of_several_things_one_must_be_as_told_and_enough_must_be_there():
    actors = [observed(index=index, **SIDES[side]) for index, side in enumerate(PLACES)]
    claims = [
        Claim(kind="count", value="4", subject="car"),
        *(Claim(kind="place", value=value, subject="car") for value in PLACES),
    ]
    (casting,) = cast([subject("car", candidates=actors, claims=claims)]).values()
    assert failed({"car": casting}) == 0
    assert casting.actor_ids == [actor.id for actor in actors]
    (fewer,) = cast([subject("car", candidates=actors[:3], claims=claims)]).values()
    assert [claim.value for claim, one in fewer.findings.items() if one.status == "fails"] == [
        "4",
        "right",
    ]


@pytest.mark.parametrize(
    ("fault", "kind", "value", "status"),
    [
        ("", "thing", "present", "holds"),
        ("", "state", "off", "fails"),
        ("", "state", "red", "open"),
        ("", "place", "ahead", "open"),
        ("missing", "thing", "present", "fails"),
        ("off", "thing", "present", "holds"),
        ("off", "state", "off", "holds"),
        ("off", "state", "flashing", "fails"),
        ("flashing", "state", "amber", "holds"),
        ("flashing", "state", "red", "fails"),
        ("bent", "state", "red", "holds"),
        ("turned", "state", "off", "fails"),
        ("off", "place", "ahead", "open"),
    ],
)
def test_things_of_the_map_are_in_order_but_for_their_fault(fault, kind, value, status):
    claims = [Claim(kind=kind, value=value, subject="traffic light")]
    (casting,) = cast(
        [subject("traffic light", claims=claims, map_fault=fault, is_scenery=True)]
    ).values()
    assert [finding.status for finding in casting.findings.values()] == [status]
