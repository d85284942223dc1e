import pytest

from oodscen import Metrics
from oodscen.data._scenario import Scenario
from oodscen.errors import DataError
from oodscen.metrics._detection.detectors import DETECTORS
from oodscen.metrics._measurements import BEST, Measurements, measurements, picture_data
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
    assert type(found).parse(found.to_json()) == found
    assert found.detector.name == BEST
    assert [len(texts.per_text) for texts in found.detector.sets.values()] == [2, 1]
    assert set(found.curves) == {"baseline", "10"}
    assert found.curves["baseline"].sizes[-1] == len(ORDINARY)
    assert [len(points) for points in found.map.points.values()] == [len(ORDINARY), 2, 1]


def test_measurements_are_read_back_and_leave_out_empty_sets():
    texts = [Scenario(id=f"s-{i}", text=text, path=("r", "x")) for i, text in enumerate(SETS["10"])]
    metrics = Metrics(HashEncoder(), ORDINARY)
    found = measurements(metrics, {"10": texts, "20": []})
    assert set(found.sets) == set(found.pictures.detector.sets) == {"10"}
    assert found.sets["10"] == metrics.report(texts)
    assert found.sets["10"].groups["r / x"].n == 2
    best = metrics.report(texts, definition=BEST).control
    assert best is not None
    assert found.pictures.detector.sets["10"].auroc == best.auroc
    assert Measurements.parse(found.to_json()) == found


@pytest.mark.parametrize(
    ("picture", "part", "name"),
    [("map", "points", "baseline"), ("map", "points", "10"), ("detector", "sets", "10")],
)
def test_measurements_without_what_a_picture_draws_are_malformed(picture, part, name):
    texts = [Scenario(id=f"s-{i}", text=text, leaf="x") for i, text in enumerate(SETS["10"])]
    found = measurements(Metrics(HashEncoder(), ORDINARY), {"10": texts}).model_dump(mode="json")
    del found["pictures"][picture][part][name]
    with pytest.raises(DataError, match=f"{part} lacks '{name}'"):
        Measurements.parse(found)


@pytest.mark.parametrize(
    "place",
    [
        ("sets", "10", "oodness", "per_text"),
        ("sets", "10", "oodness", "nearest"),
        ("sets", "10", "diversity", "nearest_index"),
        ("sets", "10", "calibration", "p_values"),
        ("pictures", "curves", "10", "sizes"),
        ("pictures", "curves", "baseline", "nearest"),
        ("paths", "leaves"),
        ("paths", "rarity", "per_text"),
    ],
)
def test_columns_that_belong_together_are_of_one_length(place):
    texts = [Scenario(id=f"s-{i}", text=text, leaf="x") for i, text in enumerate(SETS["10"])]
    found = measurements(
        Metrics(HashEncoder(), ORDINARY), {"10": texts}, {"x": "Deer", "y": "Fallen tree"}
    ).model_dump(mode="json")
    column = found
    for part in place:
        column = column[part]
    column.pop()
    with pytest.raises(DataError, match="lengths differ: "):
        Measurements.parse(found)


def test_curves_of_diversity_are_cosines():
    texts = [Scenario(id=f"s-{i}", text=text, leaf="x") for i, text in enumerate(SETS["10"])]
    found = measurements(Metrics(HashEncoder(), ORDINARY), {"10": texts}).model_dump(mode="json")
    found["pictures"]["curves"]["10"]["nearest"][0] = 1e308
    with pytest.raises(DataError, match=r"curves.10.nearest\[0\]"):
        Measurements.parse(found)


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
