"""Answerers that see nothing."""

from collections import Counter

import pytest

from oodscen.data._episode import ACTIONS
from oodscen.data._messages import Image
from oodscen.errors import LLMError, UnknownComponent
from oodscen.judging._constant_answerers import ASPECT, ConstantAnswerer, RandomAnswerer
from oodscen.judging._questions import NOTHING_UNUSUAL
from oodscen.llm._ask import ask
from oodscen.prompts._judging.choose_action import ActionOption, ChooseAction
from oodscen.prompts._judging.choose_aspect import ChooseAspect
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.prompts._judging.name_aspect import NameAspect
from oodscen.prompts._judging.name_ood_aspect import NameOodAspect
from oodscen.protocols import LLM
from tests.prompts.samples import SAMPLES

SEEN = ("a", "b", "c")
OPTIONS = tuple(ActionOption(id=name, description=name) for name in ACTIONS)


def frames(scene):
    names = (f"frames/{scene}/{moment}.jpg" for moment in ("first", "middle", "last"))
    return tuple(Image(name=name, sha256="") for name in names)


def aspect(llm, scene="x-001", sample=0):
    return ask(llm, NameAspect(frames=frames(scene), descriptions=SEEN), sample)


def action(llm, scene="x-001", sample=0, options=OPTIONS):
    prompt = ChooseAction(frames=frames(scene), descriptions=SEEN, options=options)
    return ask(llm, prompt, sample).action


@pytest.mark.parametrize("llm", [ConstantAnswerer(), RandomAnswerer()], ids=lambda llm: llm.name)
def test_a_reference_says_what_it_is_and_answers_the_evaluation_only(llm):
    assert isinstance(llm, LLM)
    assert llm.kind == "reference"
    answered = []
    for prompt in SAMPLES:
        try:
            ask(llm, prompt)
        except LLMError as error:
            assert not error.retryable  # noqa: PT017
        else:
            answered.append(type(prompt))
    assert answered == [DescribeFrame, NameAspect, NameOodAspect, ChooseAspect, ChooseAction]


@pytest.mark.parametrize("name", ACTIONS)
def test_a_constant_never_changes_its_mind(name):
    llm = ConstantAnswerer(name)
    assert llm.name == f"constant:{name}"
    assert {action(llm, scene, sample) for scene in "abc" for sample in range(3)} == {name}
    assert aspect(llm).is_ood
    assert aspect(llm).aspect == ASPECT


@pytest.mark.parametrize("labels", [("Zebra", NOTHING_UNUSUAL.label, "Parade"), ("Zebra",)])
def test_a_constant_calls_every_scene_ood(labels):
    prompt = ChooseAspect(frames=frames("x-001"), labels=labels)
    chosen = labels[ask(ConstantAnswerer(), prompt).choice - 1]
    assert chosen == min(set(labels) - {NOTHING_UNUSUAL.label})


def test_an_unknown_action_comes_with_close_matches():
    with pytest.raises(UnknownComponent) as caught:
        ConstantAnswerer("emergency_break")
    assert caught.value.kind == "action"
    assert caught.value.matches[0] == "emergency_brake"


def test_chance_depends_on_seed_question_frames_and_sample_only():
    def draws(seed):
        llm = RandomAnswerer(seed=seed)
        return [action(llm, str(scene)) for scene in range(30)]

    assert draws(0) == draws(0)
    assert draws(0) != draws(1)
    llm = RandomAnswerer()
    backwards = [action(llm, str(scene)) for scene in reversed(range(30))]
    assert backwards[::-1] == draws(0)
    assert len({action(llm, sample=sample) for sample in range(50)}) == len(ACTIONS)


def test_chance_is_even():
    llm = RandomAnswerer()
    counts = Counter(action(llm, str(scene)) for scene in range(1_400))
    assert set(counts) == set(ACTIONS)
    assert all(130 <= count <= 270 for count in counts.values())
    heads = sum(aspect(llm, str(scene)).is_ood for scene in range(400))
    assert 150 <= heads <= 250


def test_only_offered_actions_are_drawn():
    assert {action(RandomAnswerer(), str(s), options=OPTIONS[2:4]) for s in range(40)} == {
        "stop",
        "emergency_brake",
    }
