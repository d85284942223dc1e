import builtins
import subprocess
import sys

import pytest
from oodscen_pybullet._engine import load_pybullet

from oodscen.errors import MissingExtra


@pytest.mark.parametrize("missing", ["pybullet", "cv2"])
def test_a_missing_package_is_named_with_its_extra(
    missing: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = builtins.__import__

    def refuse(name: str, *args: object, **kwargs: object) -> object:
        if name == missing:
            raise ImportError(name)
        return real(name, *args, **kwargs)  # type: ignore[arg-type]  # passed on as it came

    monkeypatch.delitem(sys.modules, "pybullet", raising=False)
    monkeypatch.setattr(builtins, "__import__", refuse)
    with pytest.raises(MissingExtra) as caught:
        load_pybullet()
    assert caught.value.extra == "pybullet"
    assert caught.value.module == missing


def test_the_engine_prints_nothing() -> None:
    code = (
        "from oodscen_pybullet._engine import load_pybullet; engine = load_pybullet();"
        "engine.disconnect(engine.connect(engine.DIRECT)); print('end')"
    )
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout == "end\n"
    assert ran.stderr == ""
