from importlib.resources import files
from pathlib import Path

import pytest

from oodscen.driving.maps._shipped import SHIPPED_MAPS
from tools.maps.generate import DESIGNS, main, write


@pytest.mark.parametrize("design", DESIGNS, ids=lambda design: design.id)
def test_the_shipped_file_is_what_the_design_gives(design) -> None:
    shipped = files("oodscen.driving").joinpath(f"maps/{design.id}.xodr").read_bytes()
    assert write(design) == shipped


def test_all_designs_are_written_and_offered(tmp_path: Path) -> None:
    main([str(tmp_path)])
    written = {path.stem for path in tmp_path.iterdir()}
    assert written == {design.id for design in DESIGNS} == {road.id for road in SHIPPED_MAPS}
