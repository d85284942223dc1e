from collections.abc import Callable

import pytest
from markupsafe import Markup

from oodscen.report import parts
from oodscen.report.further import restoration_part, saturation_part
from oodscen.report.parts import Part, drawn
from oodscen.report.reading import Material, read
from oodscen.study import Study


def hello(study: Study, found: Material) -> Markup:
    return Markup("<p>{}</p>").format(len(found.scenarios))


def broken(study: Study, found: Material) -> Markup:
    raise ValueError("nothing fits")


def test_parts_are_found_by_name_and_a_broken_one_says_so(
    study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = "tests.report.test_parts"
    monkeypatch.setattr(
        parts,
        "PARTS",
        (
            Part("metrics", "Good", f"{here}:hello"),
            Part("metrics", "Bad", f"{here}:broken"),
            Part("metrics", "Gone", f"{here}:missing"),
            Part("growth", "Not installed", "oodscen.nowhere:part"),
        ),
    )
    found = drawn(study, read(study))
    assert [(one.title, str(one.markup), one.error) for one in found["metrics"]] == [
        ("Good", "<p>6</p>", ""),
        ("Bad", "", "nothing fits"),
    ]
    assert found["growth"] == []


def test_shipped_parts_draw_what_a_study_holds(study: Study) -> None:
    found = read(study)
    assert "<svg" in saturation_part(study, found)
    assert saturation_part(study, Material()) == ""
    assert restoration_part(study, Material()) == ""


def test_every_listed_part_of_the_package_is_drawn_without_error(
    make_study: Callable[..., Study],
) -> None:
    study = make_study(with_twins=True)
    assert not [one.error for row in drawn(study, read(study)).values() for one in row if one.error]
