"""The converter, on a small list of blueprints."""

import json
import subprocess
import sys

import pytest

from oodscen.data._catalogue import Asset, RoadMap, WeatherRange
from tools.carla_catalogue import EGO, POSES, TOWNS, VERSION, catalogue

SIZE = {"length": 4.0, "width": 2.0, "height": 1.0}


def listed(*rows, parameters=("fog_density", "precipitation", "sun_altitude_angle", "dust_storm")):
    needed = [(EGO, "car"), (POSES[0][0], "car"), (POSES[1][0], "truck")]
    base = [
        {"id": name, "kind": "vehicle", "category": kind, "versions": [VERSION], "size_m": SIZE}
        for name, kind in needed
    ]
    return {
        "assets": [*base, *rows],
        "weather_parameters": [{"name": name} for name in parameters],
        "maps": {town: "" for _, town, *_ in TOWNS},
    }


def walker(name, version=VERSION, **more):
    return {
        "id": f"walker.pedestrian.{name}", "kind": "walker", "category": "walker",
        "versions": [version], "size_m": SIZE, **more,
    }  # fmt: skip


def test_it_makes_valid_parts_of_a_catalogue():
    made = catalogue(listed(walker("0001", age="child"), walker("0030", role="police")))
    assets = {one["id"]: Asset.parse(one) for one in made["assets"]}
    assert assets["walker.pedestrian.0001"].names == ("child",)
    assert assets["walker.pedestrian.0030"].names == ("police_officer",)
    for one in made["maps"]:
        RoadMap.parse(one)
    assert "snow" not in WeatherRange.parse(made["weather"]).precipitation


def test_other_versions_are_left_out():
    made = catalogue(listed(walker("0001", version="0.10.0")))
    assert not any("walker" in one["id"] for one in made["assets"])


def test_what_lies_on_its_side_is_as_high_as_it_was_wide():
    made = {one["id"]: one for one in catalogue(listed())["assets"]}
    assert made[f"{POSES[1][0]}@side"]["height"] == SIZE["width"]
    assert made[f"{POSES[0][0]}@roof"]["height"] == SIZE["height"]


def test_a_list_that_has_snow_or_lacks_a_parameter_is_refused():
    with pytest.raises(ValueError, match="snow"):
        catalogue(
            listed(
                parameters=(
                    "fog_density",
                    "precipitation",
                    "sun_altitude_angle",
                    "dust_storm",
                    "snow",
                )
            )
        )
    with pytest.raises(ValueError, match="fog_density"):
        catalogue(listed(parameters=("precipitation",)))


def test_it_is_a_command(tmp_path):
    (tmp_path / "list.json").write_text(json.dumps(listed()))
    command = [sys.executable, "-m", "tools.carla_catalogue", "list.json", "-o", "made.json"]
    subprocess.run(command, cwd=tmp_path, check=True)
    assert json.loads((tmp_path / "made.json").read_text())["version"] == VERSION
