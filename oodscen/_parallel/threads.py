"""A thread pool with a sliding window: bounded, roughly in order, without batches."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def as_finished(
    function: Callable[[Item], Result],
    items: Iterable[Item],
    *,
    threads: int = 1,
    cancel: Callable[[], None] | None = None,
) -> Iterator[tuple[Item, Result]]:
    """Yield `(item, function(item))` as results arrive, with at most `threads` calls running at a time.

    An item is taken from the iterable only when a thread is free, and a thread gets its next item before
    its last result is yielded. An exception in `function` is raised in place of its item's result; calls
    that are still running are then awaited and discarded, and no new call is started. If the wait is
    interrupted (`KeyboardInterrupt`), results that still arrive are yielded before it is raised.

    Args:
        function: Called once per item.
        items: Taken one at a time.
        threads: Maximum number of concurrent calls; 1 runs them in the calling thread.
        cancel: Called once if the wait is interrupted or the caller stops iterating, so that running
            calls end soon.
    """
    if threads <= 1:
        for item in items:
            yield item, function(item)
        return
    with ThreadPoolExecutor(threads) as pool:
        source = iter(items)
        running: dict[Future[Result], Item] = {}

        def refill() -> None:
            for item in islice(source, threads - len(running)):
                running[pool.submit(function, item)] = item

        refill()
        try:
            with cancelling(cancel):
                yield from _results(running, refill)
        except KeyboardInterrupt:
            for future in list(running):
                if future.exception() is None:
                    yield running[future], future.result()
            raise


@contextmanager
def cancelling(cancel: Callable[[], None] | None) -> Iterator[None]:
    """Call `cancel` if the block is interrupted or its generator is closed early."""
    try:
        yield
    except (KeyboardInterrupt, GeneratorExit):
        if cancel is not None:
            cancel()
        raise


def _results(
    running: dict[Future[Result], Item], refill: Callable[[], None]
) -> Iterator[tuple[Item, Result]]:
    while running:
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        finished = sorted(done, key=lambda future: future.exception() is not None)
        items_done = [running.pop(future) for future in finished]
        if finished[-1].exception() is None:
            refill()
        for item, future in zip(items_done, finished, strict=True):
            yield item, future.result()
