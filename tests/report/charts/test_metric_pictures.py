from lxml import html

from oodscen.metrics import Metrics
from oodscen.metrics._pictured import picture_data
from oodscen.report._charts.metric_pictures import part
from oodscen.report._load import Material
from oodscen.testing._encoder import HashEncoder

ORDINARY = [f"A {kind} {act}." for kind in ("car", "van", "bus") for act in ("waits", "turns left")]
SETS = {"10": ["A deer jumps.", "A tree falls."], "simulatable": ["Fog.", "A bus burns & burns."]}


def material(**change: object) -> Material:
    metrics = Metrics(HashEncoder(), ORDINARY)
    content = {
        "sets": {
            name: metrics.report(texts).model_dump(mode="json") for name, texts in SETS.items()
        },
        "pictures": picture_data(metrics, SETS),
    }
    return Material(metrics={**content, **change})


def test_all_pictures_are_drawn_inside_their_boxes() -> None:
    page = html.fromstring(str(part(None, material())))  # type: ignore[arg-type]  # not read
    boxes = page.xpath("//svg")
    assert len(boxes) == len(page.xpath("//figcaption")) == 4
    for box in boxes:
        width, height = map(float, box.get("viewbox").split()[2:])
        for axis, bound in (("x", width), ("y", height)):
            for name in (axis, f"c{axis}", f"{axis}1", f"{axis}2"):
                assert all(-1 <= float(value) <= bound + 1 for value in box.xpath(f".//@{name}"))


def test_nothing_measured_or_damaged_is_nothing_shown() -> None:
    assert part(None, Material()) == ""  # type: ignore[arg-type]  # not read
    for broken in ({}, {"map": 3, "curves": {"baseline": {"sizes": ["x"]}}, "oodness": None}):
        drawn = str(part(None, material(pictures=broken)))  # type: ignore[arg-type]  # not read
        assert "nan" not in drawn
