"""A sliding window of threads: bounded, ordered enough to be fair, no batches."""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from typing import TypeVar

Item = TypeVar("Item")
Result = TypeVar("Result")


def as_finished(
    function: Callable[[Item], Result], items: Iterable[Item], *, threads: int = 1
) -> Iterator[tuple[Item, Result]]:
    """Yield `(item, function(item))` as results come, at most `threads` at a time.

    Items are taken from the iterable only when a thread is free. An exception of `function`
    surfaces at the item it belongs to; what was under way is then awaited and dropped.
    """
    if threads <= 1:
        for item in items:
            yield item, function(item)
        return
    with ThreadPoolExecutor(threads) as pool:
        source = iter(items)
        running: dict[Future[Result], Item] = {}
        while True:
            while len(running) < threads:
                try:
                    item = next(source)
                except StopIteration:
                    break
                running[pool.submit(function, item)] = item
            if not running:
                return
            done, _ = wait(running, return_when=FIRST_COMPLETED)
            for future in done:
                yield running.pop(future), future.result()
