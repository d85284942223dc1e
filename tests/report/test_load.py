import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen import Study
from oodscen.metrics._rarity.estimates import Rarity, TextRarity
from oodscen.report._load import dig, number, read

JSON = st.recursive(
    st.none() | st.booleans() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    max_leaves=12,
)


@given(JSON, st.lists(st.text(), max_size=3))
def test_looking_into_anything_never_raises(value: object, keys: list[str]) -> None:
    dig(value, *keys)
    number(value, *keys)


def test_a_torn_last_line_is_no_fault(study: Study) -> None:
    whole = read(study)
    with (study.folder / "scenarios.jsonl").open("ab") as file:
        file.write(b'{"id": "half')
    torn = read(study)
    assert torn.scenarios == whole.scenarios
    assert "scenarios.jsonl" not in torn.gaps
    assert (study.folder / "scenarios.jsonl").read_bytes().endswith(b'"half')


def test_one_bad_line_costs_only_itself(study: Study) -> None:
    file = study.folder / "scenes.jsonl"
    before = read(study)
    lines = file.read_bytes().split(b"\n")
    lines[0] = b'{"id": "broken-001"}'
    lines.insert(1, b"not json")
    file.write_bytes(b"\n".join(lines))
    after = read(study)
    assert len(after.scenes) == len(before.scenes) - 1
    assert "1 malformed line(s)" in after.gaps["scenes.jsonl"]
    assert "1 line(s) of scenes.jsonl are not JSON objects" in after.gaps["scenes.jsonl"]
    assert any(failure.id == "broken-001" for failure in after.failures)


@pytest.mark.parametrize("name", ["metrics.json", "audit.json", "tree.diverse.json"])
def test_an_object_without_members_is_a_gap(study: Study, name: str) -> None:
    (study.folder / name).write_text("{}")
    assert "cannot be read" in read(study).gaps[name]


@pytest.mark.parametrize("line", [b"not json", b'{"id": "half"}'])
def test_verdicts_of_which_a_line_is_lost_are_not_whole(study: Study, line: bytes) -> None:
    assert read(study).are_verdicts_whole
    file = study.folder / "verdicts.jsonl"
    file.write_bytes(b"\n".join([line, *file.read_bytes().split(b"\n")[1:]]))
    assert not read(study).are_verdicts_whole


def test_a_text_that_was_lost_gives_no_other_its_missing_rarity(study: Study) -> None:
    store, count = study.folder, len(read(study).scenarios)
    flags = [("not answered",), *[()] * (count - 1)]
    asked = Rarity(
        by="m", per_text=tuple(TextRarity(flags=own) for own in flags), median=None, unknown=count
    )
    metrics = json.loads((store / "metrics.json").read_bytes()) | {
        "asked": json.loads(asked.to_json())
    }
    (store / "metrics.json").write_text(json.dumps(metrics))
    info = json.loads((store / "study.json").read_bytes()) | {"failures": {"rarity": 1}}
    (store / "study.json").write_text(json.dumps(info))

    def unrated() -> list[str]:
        return [failure.id for failure in read(study).failures if failure.stage == "rarity"]

    assert unrated() == [read(study).scenarios[0].id]
    lines = (store / "scenarios.jsonl").read_bytes().split(b"\n")
    (store / "scenarios.jsonl").write_bytes(b"\n".join([b"no text", *lines[1:]]))
    assert unrated() == []


def test_reading_changes_nothing(study: Study) -> None:
    def content() -> dict[str, bytes]:
        return {f.name: f.read_bytes() for f in study.folder.iterdir() if f.is_file()}

    before = content()
    read(study)
    assert content() == before


def test_a_failed_round_is_a_failed_item_only_at_the_end(study: Study) -> None:
    rounds = [played for played in study.rounds if played.status == "ok"]
    for place, failures in ((1, []), (len(rounds) - 1, [f"round {rounds[-1].round}"])):
        changed = {"status": "failed", "error": "no answer", "decision": None, "edits": ()}
        lines = [
            played.model_copy(update=changed) if index == place else played
            for index, played in enumerate(rounds)
        ]
        study.store.write_lines("redteam.jsonl", lines)
        found = [item.id for item in read(study).failures if item.stage == "redteam"]
        assert found == failures
