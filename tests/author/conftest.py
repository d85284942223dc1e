from collections.abc import Callable
from typing import Any

import pytest

from oodscen.author._builtin import BuiltinAuthor
from oodscen.author._knowledge.base import Knowledge
from oodscen.author._knowledge.loading import load_knowledge
from oodscen.author._reading.recognition import Recogniser
from oodscen.prompts._base import Prompt
from oodscen.prompts._digest import CatalogueDigest
from oodscen.protocols import Request
from oodscen.testing._flat import FlatSimulator


@pytest.fixture(scope="session")
def knowledge() -> Knowledge:
    return load_knowledge()


@pytest.fixture(scope="session")
def recogniser(knowledge: Knowledge) -> Recogniser:
    return Recogniser(knowledge)


@pytest.fixture(scope="session")
def author() -> BuiltinAuthor:
    return BuiltinAuthor(seed=0)


@pytest.fixture(scope="session")
def catalogue() -> Any:
    return FlatSimulator().catalogue()


@pytest.fixture(scope="session")
def rich_catalogue() -> Any:
    """Everything that the PyBullet adapter shows; its data need no PyBullet."""
    return pytest.importorskip("oodscen_pybullet._catalogue").load_catalogue()


@pytest.fixture(scope="session")
def rich_digest(rich_catalogue: Any) -> CatalogueDigest:
    return CatalogueDigest.of(rich_catalogue)


@pytest.fixture(scope="session")
def digest(catalogue: Any) -> CatalogueDigest:
    return CatalogueDigest.of(catalogue)


@pytest.fixture(scope="session")
def ask() -> Callable[..., Any]:
    """Ask as the core does: parse the text, and insist that the answer is a good one."""

    def asking(llm: BuiltinAuthor, prompt: Prompt[Any], sample: int = 0, attempt: int = 1) -> Any:
        request = Request(prompt, prompt.messages(), {}, sample, attempt)
        answer = type(prompt).answer.model_validate_json(llm.complete(request).text)
        assert prompt.check(answer) == []
        return answer

    return asking
