"""Answers of a recorded model to questions about the same things, whatever the words of the question.

Pack the recording of a study into the few lines that its answers take, and use them as a model:

    python examples/recorded/recorded.py STUDY PACKED.jsonl
    PYTHONPATH=examples/recorded oodscen run OUT --llm recorded:Recorded

The model gives the answers of `answers.jsonl` beside this file, unless `RECORDED` in the environment names another.

`replay:FILE` answers only questions that are the same to the byte. Here an answer is found by what it is about: the
text, the path of labels, the number of the round. So it lasts when questions are put in better words. Answers are still
read and checked as any model's.
"""

import json
import os
import re
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from oodscen.errors import LLMError
from oodscen.protocols import Completion, Request

ANSWERS = Path(os.environ.get("RECORDED") or Path(__file__).with_name("answers.jsonl"))
ABOUT = {
    "place-scenario": 1,
    "describe-path": 0,
    "describe-ordinary": 0,
    "extract-claims": 0,
    "stage-scene": 0,
    "judge-branch": 0,
    "design-prop": 0,
    "design-motion": 0,
}
"""The place, among the fenced texts of a question, of the one that an answer is about; other questions have none."""

Line = dict[str, Any]


class Recorded:
    """A model that gives the recorded answers.

    Args:
        path: File of packed answers.
    """

    name = "recorded"

    def __init__(self, path: str | Path = ANSWERS) -> None:
        self.answers: dict[tuple[str, str], str] = {}
        self.judged: dict[str, list[str]] = {}
        for line in Path(path).read_text(encoding="utf-8").splitlines():
            one = json.loads(line)
            self.answers[one["purpose"], one["about"]] = one["answer"]
            if one["purpose"] == "judge-branch":
                self.judged.setdefault(one["about"], []).append(one["answer"])

    def complete(self, request: Request) -> Completion:
        """Return the answer to the question about the same thing.

        Raises:
            LLMError: If there is none, or it was refused before.
        """
        purpose, question = request.prompt.purpose, request.messages[-1].text
        if request.attempt > 1:
            raise LLMError("the recorded answer does not pass today's checks", model=self.name)
        if purpose == "judge-branches":
            numbered = [
                {"number": number, **self._judgement(about, request.messages[0].text)}
                for number, about in enumerate(fenced(question), start=1)
            ]
            return Completion(text=json.dumps({"judgements": numbered}))
        answer = self._answer(purpose, about_of(purpose, question, request.sample))
        if purpose == "place-scenario":
            answer = with_ids(answer, fenced(question)[0])
        return Completion(text=answer)

    def _judgement(self, about: str, catalogue: str) -> Line:
        """Return the last judgement of a leaf that names nothing beyond the catalogue: some things were made later."""
        last: Line = json.loads(self._answer("judge-branch", about))
        for answer in reversed(self.judged[about]):
            judged: Line = json.loads(answer)
            names = [*judged.get("assets", ()), *judged.get("behaviours", ())]
            if all(name in catalogue for name in names):
                return judged
        return last

    def _answer(self, purpose: str, about: str) -> str:
        try:
            return self.answers[purpose, about]
        except KeyError:
            message = f"the recording has no answer to {purpose!r} about {about!r}"
            raise LLMError(message, model=self.name) from None


def fenced(question: str) -> list[str]:
    """Return the texts of a question that are material to work on."""
    return re.findall(r"<data>(.*?)</data>", question, re.DOTALL)


def about_of(purpose: str, question: str, sample: int) -> str:
    """Return what the answer to a question is about: a fenced text, or else the number of the draw."""
    texts, place = fenced(question), ABOUT.get(purpose)
    return str(sample) if place is None or place >= len(texts) else texts[place].strip()


def with_ids(answer: str, outline: str) -> str:
    """Return a placing with today's ids: those of long labels used to be cut."""
    known = re.findall(r"\[([^\[\]]+)\]", outline)

    def now(name: object) -> object:
        longer = [one for one in known if isinstance(name, str) and one.startswith(name)]
        return name if name in known or len(longer) != 1 else longer[0]

    said = json.loads(answer)
    said["node"] = now(said.get("node"))
    said["members"] = [now(name) for name in said.get("members") or []]
    said["also"] = [{**one, "node": now(one["node"])} for one in said.get("also") or []]
    return json.dumps(said, ensure_ascii=False)


def packed(exchanges: Iterable[Mapping[str, Any]]) -> list[Line]:
    """Return one line per thing that was asked about, with the last answer, after earlier judgements of leaves."""
    found: dict[tuple[str, str], str] = {}
    earlier: list[Line] = []
    for exchange in exchanges:
        purpose, turns = str(exchange["purpose"]), exchange["messages"]
        first = len(turns) - 2 * (int(exchange.get("attempt", 1)) - 1) - 1
        question, sample = str(turns[first]["text"]), int(exchange.get("sample", 0))
        if purpose == "judge-branches":
            kinds = fenced(question)
            for judged in _object(exchange["answer"]).get("judgements", ()):
                if 1 <= judged.get("number", 0) <= len(kinds):
                    alone = {key: value for key, value in judged.items() if key != "number"}
                    about = kinds[judged["number"] - 1]
                    if before := found.get(("judge-branch", about)):
                        earlier.append(
                            {"purpose": "judge-branch", "about": about, "answer": before}
                        )
                    found["judge-branch", about] = json.dumps(alone, ensure_ascii=False)
            continue
        found[purpose, about_of(purpose, question, sample)] = str(exchange["answer"])
    return earlier + [
        {"purpose": purpose, "about": about, "answer": answer}
        for (purpose, about), answer in found.items()
    ]


def _object(answer: str) -> dict[str, Any]:
    """Return the object in an answer, which may stand in a fence or in prose."""
    found = re.search(r"\{.*\}", answer, re.DOTALL)
    value = json.loads(found.group(0)) if found else {}
    return value if isinstance(value, dict) else {}


def main(study: str, packed_file: str) -> None:
    """Pack the recording of a study into a new file."""
    try:
        lines = Path(study, "answers.jsonl").read_text(encoding="utf-8").splitlines()
        rows = packed(json.loads(line) for line in lines if line.strip())
        text = "".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows)
        with Path(packed_file).open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        sys.exit(f"{packed_file} exists; name a new file")
    except FileNotFoundError as error:
        sys.exit(
            f"{error.filename} does not exist; only a study that a model has written has a recording"
        )
    print(f"{len(rows)} answers, {len(text.encode()):,} bytes: {packed_file}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: python recorded.py STUDY PACKED.jsonl")
    main(*sys.argv[1:])
