import json

import pytest

from oodscen.metrics import DETECTORS, Metrics
from oodscen.metrics._pictured import BEST, picture_data
from oodscen.testing._encoder import HashEncoder

ORDINARY = [
    f"A {colour} {kind} {act}."
    for colour in ("red", "blue", "white", "green")
    for kind in ("car", "van", "bus", "lorry")
    for act in ("waits at the kerb", "turns left", "follows the tram and stops")
]
SETS = {"10": ["A deer jumps.", "A tree falls, and a bus burns."], "simulatable": ["Fog."]}


def test_everything_that_a_picture_needs_is_there_and_is_plain_data():
    found = picture_data(Metrics(HashEncoder(), ORDINARY), SETS)
    assert json.loads(json.dumps(found)) == found
    assert found["detector"]["name"] == BEST
    assert [len(one["per_text"]) for one in found["detector"]["sets"].values()] == [2, 1]
    assert set(found["curves"]) == {"baseline", "10"}
    assert found["curves"]["baseline"]["sizes"][-1] == len(ORDINARY)
    assert [len(points) for points in found["map"]["points"].values()] == [len(ORDINARY), 2, 1]


def test_the_same_seed_gives_the_same_pictures():
    one, other = (picture_data(Metrics(HashEncoder(), ORDINARY, seed=3), SETS) for _ in range(2))
    assert one == other


@pytest.mark.parametrize("name", ["printed", *DETECTORS])
def test_every_measure_is_calibrated(name):
    metrics = Metrics(HashEncoder(), ORDINARY)
    report = metrics.report(["A red car waits at the kerb.", "zebra lava kraken"], definition=name)
    assert report.oodness.definition == name
    assert min(report.calibration.p_values) > 0
    assert report.calibration.held_out == len(metrics.held_out_scores(name))
    assert report.control.n == 95
