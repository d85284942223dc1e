import subprocess
import sys
from collections import namedtuple
from collections.abc import Callable
from enum import IntEnum
from pathlib import Path
from typing import NamedTuple

import numpy as np

from oodscen.numerics import _kernels as compiled
from oodscen.numerics._kernels import Kernel, part, seen


@part
def twice(x: float) -> float:
    """Return the double."""
    return x + x


@Kernel
def total(numbers, factor: float) -> float:
    """Return the sum of doubles."""
    result = 0.0
    for row in range(numbers.shape[0]):
        result += twice(numbers[row]) * factor
    return result


def test_kernels_run_and_stay_readable() -> None:
    numbers = np.array([0.1, 0.7, 1e9])
    assert twice(2.0) == 4.0
    assert total(seen(numbers), 0.3) == total.plain(memoryview(numbers), 0.3)
    assert total.__doc__ == "Return the sum of doubles."


def test_without_numba_python_runs_them(monkeypatch) -> None:
    monkeypatch.setattr(compiled, "is_compiled", lambda: False)
    numbers = np.array([0.1, 0.7, 1e9])
    fresh = Kernel(total.plain)
    assert isinstance(seen(numbers), memoryview)
    assert fresh(seen(numbers), 0.3) == total.plain(memoryview(numbers), 0.3)


PART = "from oodscen.numerics._kernels import part\n"
PART += "@part\ndef grow(x):\n    return x + {shift}\n"
WHOLE = """
from oodscen.numerics._kernels import Kernel
from growth import grow
@Kernel
def twice(x):
    return grow(x) + grow(x)
print(twice(1.0), twice(1.0))
"""


def test_a_kernel_is_compiled_once_until_a_part_of_it_in_another_file_changes(
    tmp_path: Path,
) -> None:
    (tmp_path / "whole.py").write_text(WHOLE)
    settings = {
        "PYTHONPATH": str(Path(__file__).parents[2]),
        "NUMBA_CACHE_DIR": str(tmp_path / "kept"),
        "PYTHONDONTWRITEBYTECODE": "1",
        "NUMBA_DEBUG_CACHE": "1",
    }
    order = [sys.executable, "-W", "error", "whole.py"]
    for shift, result in ((0.0, "2.0 2.0"), (0.5, "3.0 3.0")):
        (tmp_path / "growth.py").write_text(PART.format(shift=shift))
        both = [
            subprocess.Popen(order, stdout=subprocess.PIPE, text=True, cwd=tmp_path, env=settings)
            for _ in range(2)
        ]
        said = [process.communicate()[0] for process in both]
        assert [text.splitlines()[-1] for text in said] == [result, result]
        assert sorted("data saved" in text for text in said) == [False, True]


SCALE: object = 1.0


def scaled(x):
    return x * SCALE


def test_a_kernel_is_built_from_its_constants(monkeypatch) -> None:
    digests = set()
    for scale in (1.0, 3.0, (1, 2), IntEnum("Code", "A"), IntEnum("Code", "A B")):
        monkeypatch.setitem(globals(), "SCALE", scale)
        digests.add(compiled._digest(scaled))
    assert len(digests) == 5


def test_a_kernel_is_compiled_anew_when_a_named_tuple_of_arrays_changes() -> None:
    def kernel_over(fields: str) -> Callable[..., object]:
        def first(pair: object) -> object:
            return pair

        first.__annotations__["pair"] = namedtuple("Pair", fields)  # made on the fly
        return first

    one, same, other = (compiled._digest(kernel_over(names)) for names in ("a b", "a b", "b a"))
    assert one == same != other


def test_a_kernel_is_compiled_anew_when_a_named_tuple_within_another_changes_or_is_renamed() -> (
    None
):
    def kernel_over(inner: type) -> Callable[..., object]:
        def first(pair: object) -> object:
            return pair

        first.__annotations__["pair"] = NamedTuple("Pair", [("a", tuple[inner, ...]), ("b", int)])
        return first

    inner = [namedtuple("Inner", "x y"), namedtuple("Inner", "y x"), namedtuple("Other", "x y")]
    assert len({compiled._digest(kernel_over(one)) for one in inner}) == 3
