"""Everything that a model was asked for in vain is counted, listed, and asked for again on demand."""

import pytest

from oodscen import Study, make_llm
from oodscen._pipeline import run_study
from oodscen.errors import LLMError
from oodscen.llm._wrapper import WrappingLLM
from oodscen.protocols import Completion
from oodscen.report._load import read
from tests.pipeline.quick import SMALL

CONFIG = SMALL.model_copy(
    update={"llm": "author", "rarity_llm": "author", "twins": True, "demands": False}
)
RARE = '{{"number": {}, "unit": "log10 km", "low": 4, "best": 5, "high": 6}}'


class Author(WrappingLLM):
    """The built-in author, who also tells rarities; refuses some questions."""

    def __init__(self, *refused, error=None):
        super().__init__(make_llm("builtin", seed=3))
        self.name = "author"
        self.refused = refused
        self.error = error

    def complete(self, request):
        prompt = request.prompt
        if prompt.purpose in self.refused and self.is_refused(prompt):
            if self.error is not None:
                raise self.error
            return Completion(text="I would rather not.")
        if prompt.purpose == "estimate-rarity":
            rows = ", ".join(RARE.format(n + 1) for n in range(len(prompt.texts)))
            return Completion(text=f'{{"estimates": [{rows}]}}')
        return self._llm.complete(request)

    def is_refused(self, prompt):
        """Refuse texts only where nothing is shown: those of a set."""
        return prompt.purpose != "describe-path" or prompt.catalogue is None


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """Run with a model that refuses nothing."""
    return run_study(tmp_path_factory.mktemp("whole"), CONFIG, models={"author": Author()})


@pytest.mark.parametrize("error", [None, LLMError("I cannot.")], ids=["words", "error"])
@pytest.mark.parametrize(
    ("purpose", "name"),
    [
        ("describe-path", "texts"),
        ("describe-ordinary", "ordinary"),
        ("estimate-rarity", "rarity"),
    ],
)
def test_what_was_asked_for_in_vain_is_counted_listed_and_asked_for_again(
    tmp_path, whole, purpose, name, error
):
    refusing = Author(purpose, error=error)
    study = run_study(tmp_path / "out", CONFIG, models={"author": refusing})
    failures = study.info["failures"]
    assert study.info["status"] == "incomplete"
    assert {table for table, number in failures.items() if number} == {name}
    listed = read(study).failures
    assert {one.stage for one in listed} == {name}
    assert len(listed) == failures[name]
    healed = run_study(tmp_path / "out", CONFIG, models={"author": Author()}, retry=True)
    assert healed.info["status"] == "success"
    for file in ("scenarios.jsonl", "texts.diverse.10.jsonl", "metrics.json"):
        assert (healed.folder / file).read_bytes() == (whole.folder / file).read_bytes()
    assert read(Study.open(tmp_path / "out")).failures == []
