"""What is given up costs questions; caps still end the run."""

import pytest

from oodscen.errors import BudgetExceeded, EndpointDown, LLMError, ModelSkipped
from oodscen.llm._circuit_breaker import CircuitBreakerLLM
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Request
from oodscen.testing import ScriptedLLM

PROMPT = ImagineScenario(shown=("A deer crosses.",))
REQUEST = Request(PROMPT, PROMPT.messages(), PROMPT.answer_schema())


def raising(error):
    def fail(request):
        raise error

    return CircuitBreakerLLM(ScriptedLLM(fail))


def test_a_model_that_is_given_up_fails_the_question_for_now():
    with pytest.raises(ModelSkipped) as caught:
        raising(EndpointDown("m at e", "no response for 40 s")).complete(REQUEST)
    assert caught.value.retryable
    assert caught.value.reason == "m at e is given up: no response for 40 s"


@pytest.mark.parametrize("error", [LLMError("no"), BudgetExceeded("requests", 1, 1)])
def test_everything_else_passes(error):
    with pytest.raises(type(error)) as caught:
        raising(error).complete(REQUEST)
    assert caught.value is error


def test_it_answers_and_looks_like_the_model():
    model = ScriptedLLM(lambda request: "said")
    model.speaks_for = "another"
    contained = CircuitBreakerLLM(model)
    assert contained.complete(REQUEST).text == "said"
    assert (contained.name, contained.speaks_for) == (model.name, "another")
