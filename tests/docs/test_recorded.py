"""The recorded answers of a strong model replay without a key, through today's questions and checks."""

import json
import sys
from pathlib import Path

import pytest

from oodscen import Augmenter, Pruner, RedTeamer, Scenario, TreeGrower, make_catalogue
from oodscen.data import Prop
from oodscen.data._designs.motion import Motion
from oodscen.errors import LLMError
from oodscen.prompts._scenario.extract_claims import ExtractClaims
from oodscen.protocols import Request

FOLDER = Path(__file__).parents[2] / "examples" / "recorded"
EVERY = 5
"""Every so many-th text is staged again; `benchmarks/models.py` stages all of another recording."""


@pytest.fixture
def recorded(monkeypatch):
    monkeypatch.syspath_prepend(FOLDER)
    yield pytest.importorskip("recorded")
    sys.modules.pop("recorded", None)


@pytest.fixture(scope="module")
def catalogue():
    return make_catalogue("pybullet")


def test_the_study_replays_up_to_the_pruned_tree(recorded, catalogue):
    model = recorded.Recorded()
    tree = TreeGrower(model).run()
    rounds = list(RedTeamer(model, catalogue=catalogue, iterations=6, in_flight=4).rounds(tree))
    assert [item.error for item in rounds if item.error] == []
    diverse = tree.apply(*(edit for item in rounds for edit in item.edits))
    assert len(diverse.leaves) >= len(tree.leaves) + 4
    designs = {
        name: [json.loads(text)[name] for (asked, _), text in model.answers.items() if asked == of]
        for name, of in (("prop", "design-prop"), ("motion", "design-motion"))
    }
    props, motions = map(Prop.parse, designs["prop"]), map(Motion.parse, designs["motion"])
    judged = list(Pruner(model, catalogue.with_made(props, motions)).decisions(diverse))
    answered = [one for one in judged if one.status == "ok"]
    assert len(answered) >= 0.75 * len(judged)
    assert sum(one.keep for one in answered) >= 0.8 * len(answered)
    assert all("has no answer" in one.error for one in judged if one.status == "failed")


def test_its_scenes_pass_todays_checks(recorded, catalogue):
    model = recorded.Recorded()
    made = [about for purpose, about in model.answers if purpose.startswith("design-")]
    texts = [
        about
        for (purpose, about), answer in model.answers.items()
        if purpose == "stage-scene"
        and not any(f'"{name}"' in answer for name in ("cannot_show", *made))
    ]
    augmenter = Augmenter(model, catalogue)
    assert len(texts) >= 40
    for text in texts[::EVERY]:
        scene = augmenter.run(Scenario(id="x", text=text, leaf="x", path=("x",)))
        assert scene.map


def test_packing_keeps_the_last_answer_and_takes_groups_apart(recorded, tmp_path):
    """Answers are found by what they are about; a second packing of what they say changes nothing."""

    def line(purpose, question, answer, attempt=1):
        turns = [{"text": "Rules."}, {"text": question}, *([{"text": "x"}] * 2 * (attempt - 1))]
        return {"purpose": purpose, "messages": turns, "answer": answer, "attempt": attempt}

    deer = "<data>A deer.</data>"
    kinds = "1. <data>a > b</data>\n2. <data>a > c</data>"
    both = {"judgements": [{"number": n, "simulatable": n == 1} for n in (1, 2, 3)]}
    rows = recorded.packed(
        [
            line("extract-claims", deer, "first"),
            line("extract-claims", f"Other words: {deer}", "mended", attempt=2),
            line("judge-branches", kinds, json.dumps(both)),
        ]
    )
    assert {(row["purpose"], row["about"]): row["answer"] for row in rows} == {
        ("extract-claims", "A deer."): "mended",
        ("judge-branch", "a > b"): '{"simulatable": true}',
        ("judge-branch", "a > c"): '{"simulatable": false}',
    }
    file = tmp_path / "answers.jsonl"
    file.write_text("".join(json.dumps(row) + "\n" for row in rows))
    model = recorded.Recorded(file)
    known, unknown = (ExtractClaims(text=text) for text in ("A deer.", "A cow."))
    assert model.complete(Request(known, known.messages(), {})).text == "mended"
    with pytest.raises(LLMError):
        model.complete(Request(unknown, unknown.messages(), {}))
    with pytest.raises(LLMError):
        model.complete(Request(known, known.messages(), {}, attempt=2))


def test_a_recording_is_packed_into_a_new_file_alone(recorded, tmp_path):
    line = {"purpose": "grow", "messages": [{"text": "Q"}], "answer": "A"}
    (tmp_path / "answers.jsonl").write_text(json.dumps(line) + "\n")
    packed = tmp_path / "packed.jsonl"
    recorded.main(str(tmp_path), str(packed))
    assert recorded.Recorded(packed).answers == {("grow", "0"): "A"}
    for study, file, fault in (
        (tmp_path, packed, "exists; name a new file"),
        (tmp_path, recorded.ANSWERS, "exists; name a new file"),
        (tmp_path / "no", tmp_path / "other.jsonl", "does not exist"),
    ):
        before = file.read_bytes() if file.exists() else None
        with pytest.raises(SystemExit, match=fault):
            recorded.main(str(study), str(file))
        assert (file.read_bytes() if file.exists() else None) == before
