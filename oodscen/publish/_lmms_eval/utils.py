"""Functions of the tasks for lmms-eval: the questions as published, scored by oodscen."""

from collections.abc import Callable, Iterable, Mapping
from typing import Any

from oodscen.publish import score_answers


def _docs_of(purpose: str) -> Callable[[Any], Any]:
    def docs_of_purpose(docs: Any) -> Any:
        return docs.filter(lambda value: value == purpose, input_columns="purpose")

    return docs_of_purpose


notice_docs = _docs_of("name-aspect")
choose_docs = _docs_of("choose-aspect")
act_docs = _docs_of("choose-action")


def doc_to_visual(doc: Mapping[str, Any]) -> list[Any]:
    """Return the frames in order."""
    return [image.convert("RGB") for image in doc["images"]]


def doc_to_text(doc: Mapping[str, Any], lmms_eval_specific_kwargs: object = None) -> str:
    """Return the instructions and the question."""
    return f"{doc['system']}\n\n{doc['question']}"


def process_results(doc: Mapping[str, Any], results: Iterable[str]) -> dict[str, Any]:
    """Return the answer and what scores it, for every figure."""
    (answer,) = results
    pair = ({name: doc[name] for name in ("purpose", "pair", "key")}, answer)
    return dict.fromkeys(_FIGURES[str(doc["purpose"])], pair)


def _figure(name: str) -> Callable[[list[tuple[Mapping[str, Any], str]]], float]:
    def aggregate(answers: list[tuple[Mapping[str, Any], str]]) -> float:
        return score_answers(answers).get(name, float("nan"))

    return aggregate


_FIGURES = {
    "name-aspect": ("notice-both", "notice", "alarms", "name"),
    "choose-aspect": ("pick",),
    "choose-action": ("act-both", "safe", "needless"),
}
notice_both = _figure("notice-both")
notice = _figure("notice")
alarms = _figure("alarms")
name = _figure("name")
pick = _figure("pick")
act_both = _figure("act-both")
safe = _figure("safe")
needless = _figure("needless")
