"""What was recorded is given again, byte for byte; what was not is explained."""

import json
from concurrent.futures import ThreadPoolExecutor

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from oodscen import make_llm
from oodscen._io.lock import locked
from oodscen._parallel.threads import as_finished
from oodscen.data._messages import Image
from oodscen.errors import (
    DataError,
    InUse,
    LLMError,
    ReplayMiss,
    StudyError,
    UnknownComponent,
    UsageError,
)
from oodscen.llm._ask import ask, speaker
from oodscen.llm._recording import Exchange, Recorder, Recording
from oodscen.llm._replay import RecordingLLM, ReplayLLM
from oodscen.prompts._judging.describe_frame import DescribeFrame
from oodscen.prompts._tree.imagine_scenario import ImagineScenario
from oodscen.protocols import Completion, Request, Usage
from oodscen.testing import ScriptedLLM

KEY = "sk-test-planted-0123456789abcdef"
QUESTION = ImagineScenario(shown=("A deer crosses.",))
OTHER = ImagineScenario(shown=("A deer sleeps.",))


def request(prompt=QUESTION, sample=0, attempt=1):
    return Request(prompt, prompt.messages(), prompt.answer_schema(), sample, attempt)


def by_sample(asked):
    usage = Usage(input_tokens=9, output_tokens=4, cost_usd=0.5)
    text = json.dumps({"text": f"A sofa lies on the road ({asked.sample})."})
    return Completion(text=text, usage=usage, requests=2)


@pytest.fixture
def file(tmp_path):
    return tmp_path / "new" / "recording.jsonl"


@given(st.lists(st.text(), min_size=1, max_size=6))
def test_answers_come_back_byte_for_byte(tmp_path_factory, texts):
    file = tmp_path_factory.mktemp("replay") / "a.jsonl"
    llm = RecordingLLM(ScriptedLLM(texts), file)
    given_answers = [llm.complete(request(sample=n)).text for n in range(len(texts))]
    replay = ReplayLLM(file)
    assert given_answers == texts
    assert [replay.complete(request(sample=n)).text for n in range(len(texts))] == texts


def test_what_is_recorded_is_not_asked_again(file):
    asked = []
    llm = ScriptedLLM(lambda r: asked.append(r.sample) or by_sample(r))
    first = RecordingLLM(llm, file).complete(request(sample=3))
    again = RecordingLLM(llm, file).complete(request(sample=3))
    assert (again.text, again.usage) == (first.text, first.usage)
    assert (first.requests, again.requests) == (2, 0)
    assert asked == [3]
    RecordingLLM(llm, file, is_reading=False).complete(request(sample=3))
    assert asked == [3, 3]


def test_a_line_says_everything(file):
    RecordingLLM(ScriptedLLM(by_sample, name="m"), file).complete(request(sample=3))
    line = json.loads(file.read_text())
    assert line.pop("seconds") >= 0
    assert line == {
        "purpose": "imagine-scenario",
        "prompt_version": ImagineScenario.version(),
        "model": "m",
        "sample": 3,
        "attempt": 1,
        "messages": [m.model_dump(mode="json") for m in QUESTION.messages()],
        "answer": by_sample(request(sample=3)).text,
        "usage": {"input_tokens": 9, "output_tokens": 4, "cached_tokens": 0, "cost_usd": 0.5},
        "requests": 2,
        "is_cut_off": False,
    }


def test_a_cut_off_answer_is_one_when_it_is_replayed(file):
    cut = RecordingLLM(ScriptedLLM(lambda asked: Completion(text="It", is_cut_off=True)), file)
    assert cut.complete(request()).is_cut_off
    assert ReplayLLM(file).complete(request()).is_cut_off


def by_hand(answer):
    """Return a line as a recording made elsewhere has it."""
    messages = [{"role": m.role, "text": m.text} for m in QUESTION.messages()]
    return json.dumps({"purpose": "imagine-scenario", "messages": messages, "answer": answer})


def test_a_recorded_answer_that_is_refused_is_told_with_its_fault(tmp_path):
    file = tmp_path / "hand.jsonl"
    file.write_text(by_hand("nope"))
    with pytest.raises(
        ReplayMiss, match=r"the answer before: .*JSON.*; attempt: recorded 1, asked"
    ):
        ask(make_llm(f"replay:{file}"), QUESTION)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
def test_a_recording_made_elsewhere_needs_three_fields(tmp_path, encoding):
    file = tmp_path / "hand.jsonl"
    file.write_text(by_hand('{"text": "A sofa lies on the road there."}') + "\n\n", encoding)
    llm = make_llm(f"replay:{file}")
    assert ask(llm, QUESTION).text == "A sofa lies on the road there."
    assert llm.name == "replay:hand.jsonl"


def test_words_of_an_unnamed_model_are_told_as_the_recordings(tmp_path):
    file = tmp_path / "own.jsonl"
    file.write_text(json.dumps({"purpose": "p", "messages": [], "answer": "a"}))
    assert speaker(ReplayLLM(file)) == "replay:own.jsonl"


def test_a_model_that_never_answered_is_refused_with_those_that_did(tmp_path):
    file = tmp_path / "own.jsonl"
    line = {"purpose": "p", "messages": [], "answer": "a"}
    file.write_text(f"{json.dumps(line)}\n{json.dumps({**line, 'model': 'gpt-4o'})}\n")
    assert speaker(ReplayLLM(f"{file}#gpt-4o")) == "gpt-4o"
    with pytest.raises(UnknownComponent, match="did you mean gpt-4o") as refused:
        ReplayLLM(f"{file}#gpt4o")
    assert refused.value.known == ("gpt-4o",)


def test_a_failure_is_not_recorded(file):
    with pytest.raises(LLMError):
        RecordingLLM(ScriptedLLM([LLMError("gone")]), file).complete(request())
    assert not file.exists()


def separated(asked):
    """Answer with separators that end no line of a recording."""
    return by_sample(asked).model_copy(update={"text": "a\u2028b\x85c"})


LINES = tuple(
    Exchange.of(request(sample=n), separated(request(sample=n)), "m", 0.5).to_json().encode()
    + b"\n"
    for n in range(3)
)


def untouched(file, work):
    """Do something and check that it leaves the file and its folder as they are."""
    before = file.read_bytes(), file.stat().st_mtime_ns, sorted(file.parent.iterdir())
    try:
        return work()
    finally:
        assert before == (file.read_bytes(), file.stat().st_mtime_ns, sorted(file.parent.iterdir()))


@settings(max_examples=40)
@given(st.integers(0, sum(map(len, LINES))))
def test_a_recording_that_is_cut_anywhere_keeps_its_whole_lines(tmp_path_factory, cut):
    file = tmp_path_factory.mktemp("cut") / "a.jsonl"
    file.write_bytes(b"".join(LINES)[:cut])
    ends = [sum(map(len, LINES[: n + 1])) - 1 for n in range(3)]
    whole = sum(cut >= end for end in ends)
    assert len(untouched(file, lambda: Recording(file))) == whole
    llm = RecordingLLM(ScriptedLLM(separated, name="m"), file)
    assert [llm.complete(request(sample=n)).requests for n in range(3)] == [
        0 if n < whole else 2 for n in range(3)
    ]
    assert sorted(Recording(file)._spans) == sorted(Exchange.parse(line).key() for line in LINES)
    # A last line that lacks only its end is whole, and nothing was written.
    assert file.read_bytes().rstrip(b"\n").count(b"\n") == 2


@settings(max_examples=40)
@given((st.binary() | st.text().map(str.encode)).filter(lambda content: b"{" not in content))
def test_what_is_no_recording_is_refused_and_left_alone(tmp_path_factory, content):
    file = tmp_path_factory.mktemp("any") / "a.jsonl"
    file.write_bytes(content)
    with pytest.raises(DataError, match="line"):
        untouched(file, lambda: ReplayLLM(file))
    if content.strip():
        with pytest.raises(DataError, match="line"):
            untouched(file, lambda: RecordingLLM(ScriptedLLM(["x"]), file).complete(request()))


@pytest.mark.parametrize(
    "content",
    [
        *("my notes\nof today", "{}", "[1]\n", '{"purpose": 1}\n{}\n', "[" * 9_999),
        *(
            f'{{"purpose": "p", "messages": [], "answer": "a", {wrong}}}\n'
            for wrong in ('"attempt": -1', '"seconds": -1', '"requests": -5', '"sample": -1')
        ),
    ],
)
def test_a_file_that_is_no_recording_is_refused_with_its_line(tmp_path, content):
    file = tmp_path / "a.jsonl"
    file.write_text(content)
    with pytest.raises(DataError, match="line 1"):
        untouched(file, lambda: make_llm(f"replay:{file}"))


def test_what_cannot_be_read_is_refused(tmp_path):
    with pytest.raises(DataError, match="No such file"):
        ReplayLLM(tmp_path / "nowhere")
    with pytest.raises(DataError, match="directory"):
        Recording(tmp_path)


def test_a_file_is_recorded_by_one_at_a_time(file):
    mine = RecordingLLM(ScriptedLLM(by_sample), file)
    mine.complete(request())
    mine._recorder.close()
    with ThreadPoolExecutor(1) as other:
        held = locked(file, "recording")
        other.submit(held.__enter__).result()
        asked = ScriptedLLM(["never asked"])
        theirs = RecordingLLM(asked, file)
        with pytest.raises(InUse, match="since 2"):
            untouched(file, lambda: theirs.complete(request(sample=1)))
        assert mine.complete(request()).requests == 0
        other.submit(held.__exit__, None, None, None).result()
    assert mine.complete(request(sample=1)).requests == 2


def test_recorders_of_one_file_in_one_process_are_one(file):
    llms = [RecordingLLM(ScriptedLLM(by_sample), file) for _ in range(4)]
    list(as_finished(lambda n: llms[n % 4].complete(request(sample=n)), range(80), threads=8))
    assert len(Recording(file)) == 80
    file.unlink()
    RecordingLLM(ScriptedLLM(by_sample), file).complete(request())
    assert len(Recording(file)) == 1


def test_a_file_that_is_removed_begins_anew_without_a_blank_line(file):
    file.parent.mkdir()
    file.write_bytes(LINES[0].rstrip(b"\n"))
    llm = RecordingLLM(ScriptedLLM(by_sample), Recorder(file))
    file.unlink()
    llm.complete(request())
    assert file.read_bytes().startswith(b'{"answer":')


def test_what_others_add_meanwhile_is_found_before_anybody_is_asked(file):
    late = RecordingLLM(ScriptedLLM(by_sample, name="m"), Recorder(file))
    RecordingLLM(ScriptedLLM(by_sample, name="m"), Recorder(file)).complete(request())
    assert late.complete(request()).requests == 0


def test_a_full_disk_is_an_error_and_leaves_whole_lines(file, monkeypatch):
    recorder = Recorder(file)
    llm = RecordingLLM(ScriptedLLM(by_sample), recorder)
    llm.complete(request())
    whole = file.read_bytes()
    append = recorder._append

    def full(line):
        with file.open("ab") as behind:
            behind.write(line[:20])
        recorder._file = None
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(recorder, "_append", full)
    with pytest.raises(StudyError, match="No space left"):
        llm.complete(request(sample=1))
    monkeypatch.setattr(recorder, "_append", append)
    llm.complete(request(sample=2))
    assert file.read_bytes().startswith(whole)
    assert len(Recording(file)) == 2


def test_many_threads_record_whole_lines(file):
    llm = RecordingLLM(ScriptedLLM(by_sample), file)
    list(as_finished(lambda n: llm.complete(request(sample=n)), range(80), threads=8))
    replay = ReplayLLM(file)
    for sample in range(80):
        assert (
            replay.complete(request(sample=sample)).text == by_sample(request(sample=sample)).text
        )


def missed(file, asked):
    with pytest.raises(ReplayMiss) as caught:
        ReplayLLM(file).complete(asked)
    return {issue.path: issue.message for issue in caught.value.differences}


def test_a_miss_says_which_part_differs(file):
    RecordingLLM(ScriptedLLM(by_sample), file).complete(request(sample=3))
    assert missed(file, request(sample=4)) == {"sample": "recorded 3, asked 4"}
    assert missed(file, request(sample=3, attempt=2)) == {"attempt": "recorded 1, asked 2"}
    differs = missed(file, request(OTHER, sample=3))
    ((place, words),) = differs.items()
    assert place == "messages[0].text"  # the examples are part of the prefix that providers cache
    assert "'crosses." in words
    assert "'sleeps." in words
    longer = Request(QUESTION, (*QUESTION.messages(),) * 2, {}, 3)
    assert missed(file, longer) == {"messages": "recorded 2 turns, asked 4"}
    frame = DescribeFrame(frames=(Image(name="a.jpg", sha256="0" * 64),))
    assert "imagine-scenario" in missed(file, request(frame))["purpose"]


def test_a_miss_names_the_picture_and_the_prompt_version(file):
    frames = [Image(name=f"{n}.jpg", sha256=str(n) * 64) for n in (1, 2)]
    prompts = [DescribeFrame(frames=(frame,)) for frame in frames]
    RecordingLLM(ScriptedLLM(["x"]), file).complete(request(prompts[0]))
    differs = missed(file, request(prompts[1]))
    assert differs == {"messages[1].images": "other pictures: recorded 1.jpg, asked 2.jpg"}
    line = json.loads(file.read_text())
    file.write_text(json.dumps({**line, "prompt_version": "old", "sample": 1}) + "\n")
    assert list(missed(file, request(prompts[0]))) == ["prompt_version", "sample"]


def test_several_models_in_one_recording_must_be_told_apart(file):
    for name in ("a", "b"):
        RecordingLLM(ScriptedLLM([f"I am {name}"], name=name), file).complete(request())
    with pytest.raises(UsageError, match="#a"):
        ReplayLLM(file).complete(request())
    assert make_llm(f"replay:{file}#b").complete(request()).text == "I am b"


def test_the_example_chooses_a_model_with_a_name(tmp_path):
    file = tmp_path / "a.jsonl"
    asked = request()
    exchanges = [Exchange.of(asked, by_sample(asked), name, 0.5) for name in ("", "gpt")]
    file.write_text("".join(f"{exchange.to_json()}\n" for exchange in exchanges))
    with pytest.raises(UsageError, match=r"\(one without a name, gpt\); choose one, e.g. .*#gpt$"):
        ReplayLLM(file).complete(request())


@given(st.sampled_from(["a.jsonl", "a#1.jsonl", "a#m"]), st.sampled_from(["m", "org/m#2", "#"]))
def test_names_of_files_and_models_may_hold_the_mark(tmp_path_factory, name, model):
    file = tmp_path_factory.mktemp("marked") / name
    RecordingLLM(ScriptedLLM(by_sample, name=model), file).complete(request())
    for source in (file, f"{file}#{model}"):
        assert speaker(ReplayLLM(source)) == model


def test_no_key_is_recorded(file, monkeypatch):
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    llm = RecordingLLM(ScriptedLLM([f"your key is {KEY}"]), file)
    prompt = ImagineScenario(shown=(f"{KEY} lies on the road.",))
    llm.complete(Request(prompt, prompt.messages(), {}))
    assert KEY not in file.read_text()
    assert Exchange.parse(file.read_text()).answer == "your key is [redacted]"


def test_a_question_with_a_key_is_answered_from_the_recording_and_a_miss_does_not_show_it(
    file, monkeypatch
):
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    asked = request(ImagineScenario(shown=(f"{KEY} lies on the road.",)))
    llm = RecordingLLM(ScriptedLLM(["once"]), file)
    assert [llm.complete(asked).text for _ in range(2)] == ["once"] * 2
    assert ReplayLLM(file).complete(asked).text == "once"
    words = missed(file, request(ImagineScenario(shown=(f"Is it {KEY}?",))))["messages[0].text"]
    assert "[redacted]" in words
    assert KEY not in words


def test_a_question_that_is_asked_again_says_how_often_it_was_answered(file):
    asked = []

    def answer(request):
        asked.append((request.sample, request.repeat))
        return "x"

    for sample, is_reading in ((0, True), (0, False), (1, True), (0, False), (0, True)):
        RecordingLLM(ScriptedLLM(answer), file, is_reading=is_reading).complete(
            request(sample=sample)
        )
    assert asked == [(0, 0), (0, 1), (1, 0), (0, 2)]
