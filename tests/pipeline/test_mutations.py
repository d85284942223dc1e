"""A broken file costs one line: never a traceback, and nothing that was only read or refused is changed."""

import pytest

from benchmarks.mutations import READERS, WRITERS, attempt, call, make_study, order_of, trials


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return make_study(tmp_path_factory.mktemp("made"))


def test_every_command_takes_the_whole_study(study) -> None:
    for name, words in (READERS | WRITERS).items():
        result = call(*order_of(words, study, study.parent / "ordinary.txt"))
        wanted = 2 if name == "simulate into it" else 0
        assert result.exit_code == wanted, (name, result.output)
    assert not attempt("Study", study, study)


def test_broken_files_cost_one_line(study) -> None:
    assert [trial for trial in trials(study, 25, 0, most=1) if trial.fault] == []
