"""A sliding window of threads: bounded, ordered enough to be fair, no batches."""

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
    """Yield `(item, function(item))` as results come, at most `threads` at a time.

    Items are taken from the iterable only when a thread is free, and a thread is busy again before
    its last result is yielded. An exception of `function` surfaces at the item it belongs to; what was
    under way is then awaited and dropped, and nothing new is begun. When the wait is interrupted
    (`KeyboardInterrupt`), results that still come are yielded before it is raised.

    Args:
        function: What is done to each.
        items: Taken one by one.
        threads: How many at a time; 1 works in the caller.
        cancel: Called once when the wait is interrupted or the results are no longer wanted, so that what is
            under way ends soon.
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
            for future in [*running]:
                if future.exception() is None:
                    yield running[future], future.result()
            raise


@contextmanager
def cancelling(cancel: Callable[[], None] | None) -> Iterator[None]:
    """Call `cancel` when the block is interrupted, or left as its results are no longer wanted."""
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
