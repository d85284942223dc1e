from pathlib import Path

import pytest
from oodscen_carla.server import _roads
from oodscen_carla.server._roads import ServedMap

from oodscen.driving._roads.building import find_map, load_corridor
from oodscen.testing._flat import FlatSimulator

LANE = (
    '<lane id="{}" type="driving" level="false"><link/>'
    '<width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane>'
)


def road(number: int, y: float, length: float, slope: float = 0.0) -> str:
    """Return a straight road with a lane in each direction."""
    return (
        f'<road name="" length="{length}" id="{number}" junction="-1"><link/><planView>'
        f'<geometry s="0" x="0" y="{y}" hdg="0" length="{length}"><line/></geometry></planView>'
        f'<elevationProfile><elevation s="0" a="0" b="{slope}" c="0" d="0"/></elevationProfile>'
        f'<lateralProfile/><lanes><laneSection s="0"><left>{LANE.format(1)}</left>'
        f'<center><lane id="0" type="none" level="false"/></center>'
        f"<right>{LANE.format(-1)}</right></laneSection></lanes></road>"
    )


def document(*roads: str, name: str = "", encoding: str = "UTF-8") -> str:
    header = (
        f'<header revMajor="1" revMinor="4" name="{name}" version="1" date="" '
        'north="0" south="0" east="0" west="0"/>'
    )
    declaration = f'<?xml version="1.0" encoding="{encoding}"?>'
    return f"{declaration}<OpenDRIVE>{header}{''.join(roads)}</OpenDRIVE>"


def served(folder: Path, *roads: str) -> ServedMap:
    return ServedMap.received(document(*roads), folder, FlatSimulator().catalogue())


@pytest.mark.parametrize("side_roads", [4, 99])
def test_spawn_points_are_those_that_pictures_show_however_many_roads_there_are(
    tmp_path: Path, side_roads: int
) -> None:
    sides = [road(number, 50.0 * number, 150.0) for number in range(1, side_roads + 1)]
    town = served(tmp_path, *sides, road(1_000, -100.0, 1_000.0))
    corridor = load_corridor(town.road_map)
    assert len(town.spawn_points) == 40
    assert all(_roads._is_shown(place, corridor) for place in town.spawn_points)


def test_there_is_a_greatest_number_of_spawn_points(tmp_path: Path) -> None:
    long = served(tmp_path, road(1, 0.0, 9_000.0))
    assert len(long.spawn_points) == 400


@pytest.mark.parametrize("most", [100, 60_000])
def test_the_ground_rises_steadily_between_samples(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, most: int
) -> None:
    monkeypatch.setattr(_roads, "_MOST_SAMPLES", most)
    hill = served(tmp_path, road(1, 0.0, 1_000.0, slope=0.1))
    for x in (0.0, 3.0, 5.0, 7.0, 14.9, 996.0):
        ground = hill.ground(x, 2.0)
        assert ground is not None
        assert ground[0] == pytest.approx(0.1 * x, abs=1e-6)
    assert hill.ground(500.0, 41.0) is None


@pytest.mark.parametrize("encoding", ["UTF-8", "ISO-8859-1", "UTF-16"])
def test_a_file_in_any_encoding_is_served_as_a_text_that_a_client_can_send_back(
    tmp_path: Path, encoding: str
) -> None:
    file = tmp_path / "town.xodr"
    text = document(road(1, 0.0, 300.0), name="Köln", encoding=encoding)
    file.write_bytes(text.encode(encoding))
    town = ServedMap.of(find_map(str(file)))
    assert 'name="Köln"' in town.text
    sent = ServedMap.received(town.text, tmp_path, FlatSimulator().catalogue())
    assert sent.spawn_points == town.spawn_points
