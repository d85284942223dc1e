"""A sliding window of threads, checked with events and never with the clock."""

import threading

import pytest
from hypothesis import given
from hypothesis import strategies as st

from oodscen._parallel import threads
from oodscen._parallel.threads import as_finished

PATIENCE = 10.0


@given(st.lists(st.integers()), st.integers(1, 6))
def test_every_item_comes_with_its_result(items, threads):
    pairs = list(as_finished(lambda item: item * 2, items, threads=threads))
    assert sorted(pairs) == sorted((item, item * 2) for item in items)


def test_one_thread_works_in_the_caller_and_in_order():
    here = threading.get_ident()
    pairs = list(as_finished(lambda item: threading.get_ident(), [3, 1, 2]))
    assert pairs == [(3, here), (1, here), (2, here)]


def test_all_threads_work_and_no_more():
    barrier = threading.Barrier(4, timeout=PATIENCE)
    lock, now, peak = threading.Lock(), [0], [0]

    def work(item):
        with lock:
            now[0] += 1
            peak[0] = max(peak[0], now[0])
        barrier.wait()
        with lock:
            now[0] -= 1

    assert len(list(as_finished(work, range(8), threads=4))) == 8
    assert peak == [4]


def test_a_slow_item_holds_nobody_up():
    release = threading.Event()

    def work(item):
        if item == 0:
            assert release.wait(PATIENCE)
        return item

    finished = []
    for item, _ in as_finished(work, range(6), threads=2):
        finished.append(item)
        if len(finished) == 5:
            release.set()
    assert finished == [1, 2, 3, 4, 5, 0]


def test_items_are_taken_only_when_a_thread_is_free():
    taken = []

    def source():
        for item in range(100):
            taken.append(item)
            yield item

    results = as_finished(lambda item: item, source(), threads=3)
    next(results)
    assert len(taken) <= 6
    results.close()


@pytest.mark.parametrize("threads", [1, 3])
def test_an_exception_surfaces_and_nothing_new_is_begun(threads):
    begun = []

    def work(item):
        begun.append(item)
        if item == 2:
            raise KeyError(item)
        return item

    results = []
    with pytest.raises(KeyError):
        results.extend(as_finished(work, range(50), threads=threads))
    assert len(begun) < 50


def test_an_interruption_cancels_and_loses_no_result_that_still_comes():
    cancelled = threading.Event()

    def work(item):
        if item == "interrupt":
            raise KeyboardInterrupt
        assert cancelled.wait(PATIENCE)
        if item == "left":
            raise KeyError(item)
        return item

    got = []
    with pytest.raises(KeyboardInterrupt):
        got.extend(
            as_finished(
                work, ["kept", "left", "interrupt", "never"], threads=3, cancel=cancelled.set
            )
        )
    assert got == [("kept", "kept")]


def test_results_that_nobody_wants_are_cancelled():
    cancelled = threading.Event()

    def work(item):
        assert item == 0 or cancelled.wait(PATIENCE)
        return item

    results = as_finished(work, range(9), threads=2, cancel=cancelled.set)
    assert next(results) == (0, 0)
    results.close()
    assert cancelled.is_set()


def test_what_finished_beside_a_failure_is_not_lost(monkeypatch):
    wait = threads.wait
    monkeypatch.setattr(threads, "wait", lambda running, return_when: wait(running))

    def work(item):
        if item == "bad":
            raise KeyError(item)
        return item

    results = as_finished(work, ["bad", "good"], threads=2)
    assert next(results) == ("good", "good")
    with pytest.raises(KeyError):
        next(results)
