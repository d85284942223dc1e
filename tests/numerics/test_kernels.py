import subprocess
import sys
from collections import namedtuple
from collections.abc import Callable
from pathlib import Path

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


SCRIPT = """
from oodscen.numerics._kernels import Kernel
@Kernel
def double(x):
    return x + x
double(1.0), double(2.0)
"""


def test_a_note_is_made_once_and_only_while_compiling(tmp_path: Path) -> None:
    file = tmp_path / "script.py"
    file.write_text(SCRIPT)
    command = [sys.executable, "-W", "error", str(file)]
    root = Path(__file__).parents[2]
    notes = [
        subprocess.run(
            command, capture_output=True, text=True, check=True, cwd=root,
            env={"PYTHONPATH": str(root), "NUMBA_CACHE_DIR": str(tmp_path / "kept")},
        ).stderr
        for _ in range(2)
    ]  # fmt: skip
    assert [note.count("compiling") for note in notes] == [1, 0]


PART = "from oodscen.numerics._kernels import part\nSCALE = {scale}\n"
PART += "@part\ndef grow(x):\n    return x * SCALE + {shift}\n"
WHOLE = """
from oodscen.numerics._kernels import Kernel
from growth import grow
@Kernel
def twice(x):
    return grow(x) + grow(x)
print(twice(1.0))
"""


def test_a_kernel_is_made_anew_when_a_part_of_it_in_another_file_changes(tmp_path: Path) -> None:
    (tmp_path / "whole.py").write_text(WHOLE)
    root = Path(__file__).parents[2]
    results = []
    for scale, shift in ((1.0, 0.0), (1.0, 0.5), (3.0, 0.5)):
        (tmp_path / "growth.py").write_text(PART.format(scale=scale, shift=shift))
        ran = subprocess.run(
            [sys.executable, "whole.py"], capture_output=True, text=True, check=True, cwd=tmp_path,
            env={"PYTHONPATH": str(root), "NUMBA_CACHE_DIR": str(tmp_path / "kept"),
                 "PYTHONDONTWRITEBYTECODE": "1"},
        )  # fmt: skip
        results.append(float(ran.stdout))
    assert results == [2.0, 3.0, 7.0]


def test_a_kernel_is_compiled_anew_when_a_named_tuple_of_arrays_changes() -> None:
    def kernel_over(fields: str) -> Callable[..., object]:
        def first(pair: object) -> object:
            return pair

        first.__annotations__["pair"] = namedtuple("Pair", fields)  # made on the fly
        return first

    one, same, other = (compiled._digest(kernel_over(names)) for names in ("a b", "a b", "b a"))
    assert one == same != other
