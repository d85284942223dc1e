"""Questions about a drive: what is shown of it, and how the options and answers are read."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen.data._episode import ACTIONS, Episode
from oodscen.data._messages import Image
from oodscen.data._verdict import NOTHING
from oodscen.judging._questions import (
    OPTIONS,
    ShownDrive,
    acting_prompt,
    acting_reader,
    aspect_options,
    choosing_prompt,
    choosing_reader,
    naming_reader,
    paragraphs,
)
from oodscen.judging._references import AspectOption

KINDS = tuple(AspectOption(id=f"leaf-{n}", label=f"Kind {n}") for n in range(7))


def image(name: str) -> Image:
    return Image(name=name, path=f"{name}.jpg", sha256="0" * 64)


def drive(**fields: object) -> Episode:
    return Episode.parse({"id": "x-001", "scene_id": "x-001", "status": "ok", **fields})


@given(st.integers(0, 2**32 - 1), st.text(max_size=8))
def test_options_are_the_kinds_and_nothing_in_an_order_of_the_item_alone(seed, item):
    options = aspect_options(KINDS, seed=seed, item=item)
    assert sorted(option.id for option in options) == sorted([NOTHING, *(k.id for k in KINDS)])
    assert options == aspect_options(KINDS, seed=seed, item=item)


def test_every_action_is_offered_and_read():
    assert [option.id for option in OPTIONS] == list(ACTIONS)
    reader = acting_reader()
    for action in ACTIONS:
        answer, faults, _ = reader.read(f'{{"action": "{action}"}}', model="m")
        assert (reader.fields(answer)["action"], faults) == (action, [])


@pytest.mark.parametrize(
    "raw",
    [
        '{"action": "keep_speed", "reasoning": "Therefore I will stop."}',
        '{"action": "keep_speed", "explanation": "Therefore I will stop."}',
        '{"answer": {"action": "keep_speed", "reason": "Therefore I will stop."}}',
        "Reason: Therefore I will stop.\nAction: keep_speed",
    ],
)
def test_reasons_for_another_action_are_noted_however_they_are_given(raw):
    reader = acting_reader()
    answer, _, _ = reader.read(raw, model="m")
    found = reader.fields(answer)
    assert found["reasoning"].startswith("Therefore I will stop")
    assert "settles on stop" in found["contradiction"]


def test_a_choice_is_read_as_the_id_of_its_option():
    options = aspect_options(KINDS, seed=0, item="x-001")
    reader = choosing_reader(options)
    for number, option in enumerate(options, start=1):
        answer, _, _ = reader.read(f'{{"choice": {number}}}', model="m")
        assert reader.fields(answer) == {"choice": option.id}


def test_what_cannot_be_read_comes_with_the_expected_form():
    answer, faults, _ = naming_reader().read("perhaps", model="m")
    assert answer is None
    assert '"is_ood": true or false' in str(faults[0])


def test_the_paper_s_question_has_nothing_unusual_where_none_is_named():
    reader = naming_reader("paper")
    for raw, is_ood in (('{"aspect": "none"}', False), ('{"aspect": "a deer"}', True)):
        answer, _, _ = reader.read(raw, model="m")
        assert reader.fields(answer)["is_ood"] is is_ood


def test_frames_stand_in_order_of_time_and_their_times_with_them():
    frames = {moment: image(moment) for moment in ("last", "first", "middle")}
    times = {"first": 0.0, "middle": 1.5, "last": 3.0}
    shown = ShownDrive.of(drive(frame_times_s=times), frames)
    assert [picture.name for picture in shown.images] == ["first", "middle", "last"]
    assert shown.facts.times_s == (0.0, 1.5, 3.0)
    assert ShownDrive.of(drive(frame_times_s={"first": 0.0}), frames).facts.times_s == ()


def test_who_follows_is_a_noun_with_its_article():
    truck = {"what": "garbage_truck", "gap_m": 9.0, "speed_mps": 8.0}
    ambulance = truck | {"what": "ambulance"}
    frames = {"last": image("last")}
    behind = [
        ShownDrive.of(drive(**fields), frames).facts.behind
        for fields in ({"follower": truck}, {"follower": ambulance}, {"ego_speed_mps": 8.0}, {})
    ]
    assert behind == ["a garbage truck", "an ambulance", "", None]


def test_without_pictures_the_question_has_the_same_facts():
    shown = ShownDrive.of(drive(), {"first": image("first"), "last": image("last")})
    blind = shown.without_pictures()
    assert (blind.images, blind.rear, blind.withheld, blind.facts) == ((), None, 2, shown.facts)


def test_paragraphs_hold_the_whole_question():
    shown = ShownDrive((image("last"),))
    for prompt in (acting_prompt(shown), choosing_prompt(shown, KINDS)):
        assert " ".join(paragraphs(prompt)).split() == prompt.question().split()
