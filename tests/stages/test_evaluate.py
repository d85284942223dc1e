"""Judging: both tasks, the executed action decides, failures are verdicts."""

import json

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from oodscen import evaluate, simulate
from oodscen._io.jpeg import to_jpeg
from oodscen.data._episode import ACTIONS, MOMENTS, ActionOutcome, Episode, Follower, moments
from oodscen.data._messages import Image
from oodscen.data._verdict import Verdict
from oodscen.errors import ContentFiltered, LLMError, LLMTimeout, ModelSkipped, UsageError
from oodscen.judging._aspects.matching import names_aspect
from oodscen.judging._constant_answerers import ConstantAnswerer, RandomAnswerer
from oodscen.judging._questions import ShownDrive, aspect_options
from oodscen.judging._references import Answers, AspectOption
from oodscen.protocols import Frame
from oodscen.testing import ScriptedLLM
from oodscen.testing._flat import FlatSimulator
from oodscen.testing._scenes import example_scene

PATH = ("OOD", "Environmental", "Overturned vehicles", "Overturned vehicle ahead")
EPISODE = Episode(
    id="x-001",
    scene_id="x-001",
    status="ok",
    actions={name: ActionOutcome(safe=name in ("stop", "emergency_brake")) for name in ACTIONS},
)


JPEG = b"\xff\xd8\xff%b\xff\xd9"
"""Bytes that begin and end as a JPEG does."""


@pytest.fixture
def frames(tmp_path):
    images = {}
    for moment in MOMENTS:
        path = tmp_path / f"{moment}.jpg"
        path.write_bytes(JPEG % moment.encode())
        images[moment] = Image.from_file(path, f"frames/x-001/{moment}.jpg")
    return images


def answers(aspect="an overturned truck", action="stop"):
    return {
        "describe-frame": [{"description": f"frame {n}"} for n in (1, 2, 3)],
        "name-aspect": {"reasoning": "", "is_ood": True, "aspect": aspect},
        "choose-action": {"reasoning": "", "action": action},
    }


def test_frames_of_a_run_are_shown_as_a_study_stores_them():
    with FlatSimulator() as simulator:
        run = simulate(example_scene(), simulator)
    llm = ScriptedLLM(answers())
    rear = run.frames["first"]
    assert evaluate(run.episode, run.frames, llm, path=PATH, rear=rear).status == "ok"
    *shown, behind = llm.requests[0].messages[-1].images
    assert [image.name for image in shown] == [f"frames/example-001/{name}.jpg" for name in MOMENTS]
    assert [image.read() for image in shown] == [to_jpeg(run.frames[name].rgb) for name in MOMENTS]
    assert (behind.name, behind.sha256) == ("frames/example-001/rear.jpg", shown[0].sha256)
    assert not any(image.fault() for image in (*shown, behind))


@pytest.mark.parametrize(
    "rgb",
    [
        np.zeros((4, 6), np.uint8),
        np.zeros((4, 6, 4), np.uint8),
        np.zeros((3, 4, 6), np.uint8),
        np.zeros((4, 6, 3)),
        np.zeros((4, 6, 3), bool),
        np.zeros((0, 6, 3), np.uint8),
        [[[0, 0, 0]]],
        None,
    ],
)
def test_what_are_no_colours_is_no_picture(rgb):
    llm = ScriptedLLM(answers())
    odd = Frame(rgb, np.zeros((4, 6), np.float32), np.zeros((4, 6), np.int32))
    with pytest.raises(
        UsageError, match=r"the last frame's rgb must be uint8 \[height, width, 3\], not "
    ):
        evaluate(EPISODE, {"last": odd}, llm, path=PATH)
    assert not llm.requests


def test_what_has_no_truth_is_not_judged(frames):
    llm = ScriptedLLM(answers())
    for path in ((), (" ",)):
        with pytest.raises(UsageError, match="path must have"):
            evaluate(EPISODE, frames, llm, path=path)
    failed = EPISODE.model_copy(update={"status": "failed", "actions": {}})
    with pytest.raises(UsageError, match="'x-001' failed"):
        evaluate(failed, frames, llm, path=PATH)
    assert not llm.requests


def test_a_file_that_is_no_picture_is_not_shown(frames, tmp_path):
    (tmp_path / "last.jpg").write_text("import this")
    llm = ScriptedLLM(answers())
    odd = Image.from_file(tmp_path / "last.jpg")
    for shown in ({**frames, "last": odd}, {**frames, "last": Image(name="x", sha256="0" * 64)}):
        with pytest.raises(UsageError, match="frames: "):
            evaluate(EPISODE, shown, llm, path=PATH)
    assert not llm.requests


@pytest.mark.parametrize(
    "choice", [{"withheld": True}, {"rear": Image.from_bytes(JPEG % b"", "r")}]
)
def test_what_the_paper_s_protocol_lacks_is_refused_in_it(frames, choice):
    with pytest.raises(UsageError, match="paper's protocol"):
        evaluate(EPISODE, frames, ScriptedLLM(answers()), path=PATH, protocol="paper", **choice)


def test_a_model_is_not_asked_about_no_frame():
    llm = ScriptedLLM(answers())
    for withheld in (False, True):
        with pytest.raises(UsageError, match="no frame"):
            evaluate(EPISODE, {}, llm, path=PATH, withheld=withheld)
    assert not llm.requests


def test_the_papers_action_is_not_asked_about_no_frame(frames):
    llm = ScriptedLLM(answers())
    for shown, before in (({"last": frames["last"]}, None), (frames, ShownDrive(()))):
        with pytest.raises(UsageError, match="no frame of the drive up to the decision"):
            evaluate(EPISODE, shown, llm, path=PATH, protocol="paper", before=before)
    assert not llm.requests
    assert evaluate(EPISODE, shown, llm, path=PATH, before=before).status == "ok"


def test_both_tasks_are_scored(frames):
    verdict = evaluate(EPISODE, frames, ScriptedLLM(answers()), path=PATH)
    assert verdict.id == "x-001@scripted"
    assert verdict.descriptions == ()
    assert verdict.thing_is_right
    assert verdict.aspect_is_right
    assert verdict.action_is_safe
    wrong = ScriptedLLM(answers("a deer", "keep_speed"))
    verdict = evaluate(EPISODE, frames, wrong, path=PATH)
    assert verdict.aspect_is_right is False
    assert verdict.action_is_safe is False


def test_frames_are_shown_in_turn_with_what_was_said_about_the_earlier_ones(frames):
    llm = ScriptedLLM(answers())
    verdict = evaluate(EPISODE, frames, llm, path=PATH, chain=True)
    assert verdict.descriptions == ("frame 1", "frame 2", "frame 3")
    pictures = [
        [image.name for message in request.messages for image in message.images]
        for request in llm.requests
    ]
    names = [f"frames/x-001/{moment}.jpg" for moment in MOMENTS]
    assert pictures == [names[:1], names[:2], names, names, names]
    assert "frame 2" in llm.requests[2].messages[-2].text


def test_questions_stand_alone_and_state_what_no_frame_shows(frames):
    follower = Follower(gap_m=9.6, speed_mps=14.0, what="delivery_van")
    known = {
        "ego_speed_mps": 13.9,
        "frame_times_s": dict(zip(MOMENTS, (0.0, 1.2, 2.4), strict=True)),
    }
    for behind in (follower, None):
        llm = ScriptedLLM(answers())
        episode = EPISODE.model_copy(update=known | {"follower": behind})
        evaluate(episode, frames, llm, path=PATH)
        assert [request.prompt.purpose for request in llm.requests] == [
            "name-aspect",
            "choose-action",
        ]
        for request in llm.requests:
            (question,) = (message for message in request.messages if message.role == "user")
            assert len(question.images) == len(MOMENTS)
            assert "0.0 s, 1.2 s, 2.4 s after the start" in question.text
            assert "drives at 13.9 m/s (50 km/h)" in question.text
            assert ("a delivery van follows" in question.text) == (behind is not None)
            assert ("Nobody follows" in question.text) == (behind is None)


def test_the_view_to_the_rear_comes_after_the_frames_and_is_named(frames):
    rear = Image.from_bytes(JPEG % b"rear", "rear")
    for shown in (None, rear):
        llm = ScriptedLLM(answers())
        evaluate(EPISODE, frames, llm, path=PATH, rear=shown)
        for request in llm.requests:
            question = request.messages[-1]
            assert [image.name for image in question.images[3:]] == ["rear"] * (shown is not None)
            assert ("looks back" in question.text) == (shown is not None)
    llm = ScriptedLLM(answers())
    evaluate(EPISODE, frames, llm, path=PATH, rear=rear, chain=True)
    names = [[image.name for image in request.messages[-1].images] for request in llm.requests]
    assert names[-2:] == [["rear"], ["rear"]]
    assert not any("rear" in name for name in names[:-2])


def test_of_what_is_unknown_nothing_is_said(frames):
    llm = ScriptedLLM(answers())
    evaluate(EPISODE, frames, llm, path=PATH)
    assert "follow" not in llm.requests[0].messages[-1].text
    assert "m/s" not in llm.requests[0].messages[-1].text


def test_five_frames_are_shown_in_order_of_time():
    shown = {}
    for moment in reversed(moments(5)):
        shown[moment] = Image.from_bytes(JPEG % moment.encode(), moment)
    llm = ScriptedLLM(answers())
    evaluate(EPISODE, shown, llm, path=PATH)
    names = [image.name for image in llm.requests[0].messages[-1].images]
    assert names == ["first", "at-25", "middle", "at-75", "last"]


def test_in_the_paper_s_protocol_the_action_is_asked_before_the_outcome_is_shown(frames):
    said = {**answers(), "name-ood-aspect": {"aspect": "an overturned truck"}}
    said["describe-frame"] = {"description": "a road"}
    llm = ScriptedLLM(said)
    evaluate(EPISODE, frames, llm, path=PATH, protocol="paper")
    asked = [request.prompt.purpose for request in llm.requests]
    assert asked.index("choose-action") < asked.index("name-ood-aspect")
    before = llm.requests[: asked.index("choose-action") + 1]
    seen = {image.name for one in before for message in one.messages for image in message.images}
    assert not any("last" in name for name in seen)
    llm = ScriptedLLM(said)
    decided = ShownDrive(tuple(frames.values()))
    evaluate(EPISODE, frames, llm, path=PATH, protocol="paper", before=decided)
    action = next(one for one in llm.requests if one.prompt.purpose == "choose-action")
    assert action.prompt.frames == decided.images


def test_a_model_that_fails_is_a_verdict_with_what_was_seen_so_far(frames):
    def answer(request):
        if request.prompt.purpose == "describe-frame":
            return {"description": "a road"}
        raise LLMError("out of credit")

    verdict = evaluate(EPISODE, frames, ScriptedLLM(answer), path=PATH, chain=True)
    assert verdict.status == "failed"
    assert len(verdict.descriptions) == 3
    assert "out of credit" in verdict.error


def test_an_action_that_is_not_offered_is_sent_back(frames):
    llm = ScriptedLLM({**answers(), "choose-action": [{"action": "fly"}, {"action": "stop"}]})
    assert evaluate(EPISODE, frames, llm, path=PATH).action == "stop"
    assert "'fly' is no option" in llm.requests[-1].messages[-1].text


@pytest.mark.parametrize("action", ACTIONS)
def test_constant_answerers_score_what_their_action_scored(frames, action):
    verdict = evaluate(EPISODE, frames, ConstantAnswerer(action), path=PATH)
    assert verdict.kind == "reference"
    assert verdict.action_is_safe == EPISODE.actions[action].safe


class _OwnReference:
    name, kind = "own", "reference"

    def __init__(self, answers):
        self.answers = answers

    def complete(self, request):
        raise NotImplementedError

    def judge(self, case):
        return self.answers()


@pytest.mark.parametrize(
    ("answers", "fault"),
    [
        (lambda: 1 / 0, "division by zero"),
        (lambda: None, "None, not Answers"),
        (lambda: Answers(is_ood=True, confidence=7), "confidence"),
        (lambda: Answers(is_ood=True, action="fly"), "unknown action"),
    ],
)
def test_a_reference_whose_code_fails_is_a_verdict(answers, fault):
    verdict = evaluate(EPISODE, {}, _OwnReference(answers), path=PATH)
    assert (verdict.status, verdict.outcome, verdict.action) == ("failed", "error", None)
    assert fault in verdict.error
    good = _OwnReference(lambda: Answers(is_ood=True, action="stop"))
    assert evaluate(EPISODE, {}, good, path=PATH).action_is_safe


def test_the_random_answerer_is_repeatable(frames):
    first, again = (evaluate(EPISODE, frames, RandomAnswerer(seed=4), path=PATH) for _ in "ab")
    assert first == again
    assert first.kind == "reference"


@pytest.mark.parametrize(
    ("aspect", "label", "right"),
    [
        ("dense fog at night", "Thick fog at night with a vehicle ahead", True),
        ("a car going the wrong way", "Vehicle driving the wrong way", True),
        ("cardboard boxes", "Large cardboard box on the road", True),
        ("a vehicle ahead", "Thick fog at night with a vehicle ahead", False),
        ("something on the road", "Large cardboard box on the road", False),
        ("", "Fallen tree", False),
    ],
)
def test_an_aspect_must_share_a_telling_word_with_the_label(aspect, label, right):
    assert names_aspect(aspect, ("OOD", label)) is right


@pytest.mark.parametrize(
    ("said", "outcome", "action"),
    [
        ("The box is near, so I would slow down.", "answered", "slow_down"),
        ("I'm sorry, but I can't help with that.", "refused", None),
        ("Ich würde langsam anhalten.", "unparsed", None),
        ("I would stop if there were room, but there is not, so brake hard.", "unparsed", None),
        ("I refuse to stop.", "unparsed", None),
        ("I'd do the opposite of stop.", "unparsed", None),
        ("The truck should stop.", "unparsed", None),
        ('{"action":"stop","action":"keep_speed"}', "unparsed", None),
        ("Pysäyttäisin auton varovasti.", "unparsed", None),
        ("stop or pull_over", "unparsed", None),
        ("x" * 1_000_000, "unparsed", None),
        ('{"action": "fly"}', "unparsed", None),
    ],
)
def test_what_a_model_says_in_its_own_way_has_a_typed_outcome(frames, said, outcome, action):
    llm = ScriptedLLM({**answers(), "choose-action": said})
    verdict = evaluate(EPISODE, frames, llm, path=PATH)
    assert (verdict.outcome, verdict.action) == (outcome, action)
    assert verdict.aspect_is_right
    assert verdict.action_is_safe is (None if action is None else EPISODE.actions[action].safe)
    asked = sum(request.prompt.purpose == "choose-action" for request in llm.requests)
    assert asked == (2 if outcome == "unparsed" else 1)
    if action:
        assert verdict.notes


def test_an_answer_that_cannot_be_read_is_asked_for_once_more_in_the_right_form(frames):
    said = {**answers(), "choose-action": ["I refuse to stop.", "I would slow down."]}
    said["name-aspect"] = ["Maybe.", "Yes, an overturned truck."]
    llm = ScriptedLLM(said)
    verdict = evaluate(EPISODE, frames, llm, path=PATH)
    assert (verdict.outcome, verdict.action, verdict.is_ood) == ("answered", "slow_down", True)
    assert '"action": exactly one of keep_speed, slow_down' in llm.requests[-1].messages[-1].text
    assert verdict.notes == ("name-aspect: prose", "choose-action: prose")


def test_a_model_that_does_not_answer_in_time_is_told_from_one_that_fails(frames):
    def late(request):
        raise TimeoutError("120 s")

    verdict = evaluate(EPISODE, frames, ScriptedLLM(late), path=PATH)
    assert (verdict.outcome, verdict.status, verdict.retryable) == ("timeout", "failed", True)


@pytest.mark.parametrize(
    ("error", "outcome", "retryable"),
    [
        (ContentFiltered("declined by a filter"), "refused", False),
        (ModelSkipped("m is given up", model="m"), "unasked", True),
        (LLMTimeout("the answer did not end", retryable=True), "timeout", True),
        (LLMError("boom", retryable=True), "error", True),
    ],
)
def test_what_keeps_a_model_from_answering_has_a_typed_outcome(frames, error, outcome, retryable):
    def fail(request):
        raise error

    verdict = evaluate(EPISODE, frames, ScriptedLLM(fail), path=PATH)
    assert (verdict.outcome, verdict.status, verdict.retryable) == (outcome, "failed", retryable)
    assert verdict.error_type == type(error).__name__


def test_a_filter_that_declines_one_question_costs_that_question(frames):
    llm = ScriptedLLM(by_purpose)
    verdict = evaluate(EPISODE, frames, llm, path=PATH)
    assert (verdict.outcome, verdict.action, verdict.is_ood) == ("refused", "stop", None)


def by_purpose(request):
    if request.prompt.purpose == "name-aspect":
        raise ContentFiltered("declined by a filter")
    said = answers()[request.prompt.purpose]
    return said[0] if isinstance(said, list) else said


def test_an_unavailable_action_is_not_safe_and_counted(frames):
    outcomes = {**EPISODE.actions, "change_lane_left": ActionOutcome(safe=False, unavailable=True)}
    episode = EPISODE.model_copy(update={"actions": outcomes})
    llm = ScriptedLLM(answers(action="change_lane_left"))
    verdict = evaluate(episode, frames, llm, path=PATH)
    assert verdict.outcome == "unavailable"
    assert verdict.action_is_safe is verdict.success is False


def test_the_closed_question_is_scored_by_its_leaf_and_shuffled_by_item(frames):
    kinds = [
        AspectOption(id="deer", label="Deer on the road"),
        AspectOption(id="wreck", label="Overturned vehicle"),
    ]
    options = aspect_options(kinds, seed=1, item="x-001")
    assert options == aspect_options(kinds, seed=1, item="x-001")
    assert len({aspect_options(kinds, seed=1, item=str(n)) for n in range(20)}) > 1
    place = [option.id for option in options].index("wreck") + 1
    llm = ScriptedLLM({**answers(), "choose-aspect": {"choice": place}})
    verdict = evaluate(EPISODE, frames, llm, path=PATH, leaf="wreck", options=options)
    assert verdict.choice == "wreck"
    assert verdict.choice_is_right
    twin = EPISODE.model_copy(update={"id": "x-001~twin", "scene_id": "x-001~twin"})
    llm = ScriptedLLM({**answers(), "choose-aspect": {"choice": place}})
    verdict = evaluate(twin, frames, llm, path=PATH, leaf="wreck", options=options)
    assert verdict.is_ordinary
    assert verdict.choice_is_right is False
    assert verdict.aspect_is_right is None


def test_a_judge_model_is_recorded_with_its_prompt(frames):
    judge = ScriptedLLM({"judge-aspect": {"is_same_thing": True, "is_same_fault": True}})
    verdict = evaluate(
        EPISODE, frames, ScriptedLLM(answers("a flipped van")), path=PATH, judge=judge
    )
    assert verdict.aspect_is_right
    assert verdict.judge.startswith("scripted@")


said = st.text(
    st.sampled_from("\ud800\udfff\x00\x1b\u202e<>&\"'") | st.characters(), max_size=12
) | st.sampled_from(["Ich halte an.", "I'm sorry, I can't help with that.", "fly", "1", "stop", ""])
raised = st.sampled_from([TimeoutError(), KeyError("choices"), LLMError("gone"), RecursionError()])
replies = raised | said | st.fixed_dictionaries(
    {},
    optional={
        "reasoning": said,
        "description": said,
        "is_ood": st.booleans() | said,
        "aspect": said,
        "confidence": st.floats() | said,
        "choice": st.integers(-1, 4) | said,
        "action": st.sampled_from([*ACTIONS, "fly"]) | said,
    },
)  # fmt: skip


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(replies, min_size=6, max_size=6))
def test_whatever_a_model_does_its_verdict_is_typed_and_can_be_written(frames, plan):
    def answer(request):
        reply = plan[(len(request.messages) + request.attempt) % len(plan)]
        if isinstance(reply, Exception):
            raise reply
        return reply if isinstance(reply, str) else json.dumps(reply)

    kinds = [AspectOption(id="wreck", label="Overturned vehicle")]
    options = aspect_options(kinds, seed=1, item="x-001")
    verdict = evaluate(
        EPISODE, frames, ScriptedLLM(answer), path=PATH, leaf="wreck", options=options
    )
    assert Verdict.parse(verdict.to_json().encode()) == verdict
    assert (verdict.status == "failed") == (verdict.outcome not in ("answered", "unavailable"))
    assert (verdict.status == "failed") == bool(verdict.error)
    assert verdict.action in (None, *ACTIONS)
    assert len(verdict.to_json()) < 20_000


def test_of_endless_words_a_beginning_is_kept(frames):
    words = "A cow lies on a road. " * 3_000
    said = {**answers(), "describe-frame": {"description": words}}
    said["name-aspect"] = {"reasoning": words, "is_ood": True, "aspect": words, "confidence": 0.5}
    said["choose-action"] = {"reasoning": words, "action": "stop"}
    llm = ScriptedLLM(said)
    verdict = evaluate(EPISODE, frames, llm, path=PATH)
    assert verdict.status == "ok"
    assert len(verdict.to_json()) < 25_000
    assert sum(len(message.text) for message in llm.requests[-1].messages) < 40_000


def test_the_paper_s_protocol_asks_which_aspect_and_hints_at_no_ordinary_drives(frames):
    said = {**answers(), "name-ood-aspect": {"aspect": "an overturned truck"}}
    said["describe-frame"] = {"description": "a road"}
    del said["name-aspect"]
    llm = ScriptedLLM(said)
    verdict = evaluate(EPISODE, frames, llm, path=PATH, protocol="paper")
    assert (verdict.is_ood, verdict.confidence, verdict.aspect_is_right) == (True, None, True)
    assert "name-aspect" not in verdict.prompts
    question = next(r for r in llm.requests if r.prompt.purpose == "name-ood-aspect")
    asked = question.messages[-1].text.casefold()
    for hint in ("half", "ordinary", "confiden", "sure", "is_ood"):
        assert hint not in asked
    said["name-ood-aspect"] = {"aspect": "none"}
    nothing = evaluate(EPISODE, frames, ScriptedLLM(said), path=PATH, protocol="paper")
    assert (nothing.is_ood, nothing.aspect, nothing.aspect_is_right) == (False, "", False)
