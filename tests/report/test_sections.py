"""Parts of the page: their place, their templates, and what becomes of a file or a name that is wrong."""

from collections.abc import Callable, Mapping
from typing import Any, get_args

import jinja2
import pytest

from oodscen import Study
from oodscen.errors import DataError, Issue
from oodscen.report import _sections as sections
from oodscen.report._load import Material, read
from oodscen.report._render import render_part
from oodscen.report._sections import PARTS, PagePart, Place, RenderedPart, collect_parts


def hello(study: Study, found: Material) -> Mapping[str, Any]:
    return {"pictures": [(len(found.scenarios), "texts")]}


def unreadable(study: Study, found: Material) -> Mapping[str, Any]:
    raise DataError("study", [Issue("rows[3]", "nothing fits")])


def mistaken(study: Study, found: Material) -> Mapping[str, Any]:
    return {"texts": found.scenarois}  # type: ignore[attr-defined]  # the mistake


def test_a_broken_file_is_a_note_in_its_place(
    study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = (
        PagePart("metrics", "Good", "pictures", hello),
        PagePart("metrics", "Bad", "pictures", unreadable),
    )
    monkeypatch.setattr(sections, "PARTS", here)
    good, bad = collect_parts(study, read(study))["metrics"]
    assert "6<figcaption>texts" in render_part(good)
    assert (bad.title, bad.data) == ("Bad", {})
    assert "rows[3]: nothing fits" in bad.error


def test_a_misspelt_attribute_ends_the_report(
    study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sections, "PARTS", (PagePart("metrics", "Bad", "pictures", mistaken),))
    with pytest.raises(AttributeError):
        collect_parts(study, read(study))


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.template)
def test_a_template_sees_its_own_data_alone_and_nothing_else(part: PagePart) -> None:
    with pytest.raises(jinja2.UndefinedError):
        render_part(RenderedPart(part.title, part.template, {"metrics": 1, "study": 2}))


def test_every_place_has_a_part() -> None:
    assert {part.place for part in PARTS} == set(get_args(Place))


def test_shipped_parts_draw_what_a_study_holds(make_study: Callable[..., Study]) -> None:
    study = make_study(with_twins=True)
    places = collect_parts(study, read(study))
    assert not [one.error for row in places.values() for one in row if one.error]
    (chart,) = places["growth"]
    assert "<svg" in render_part(chart)
    assert not [one for row in collect_parts(study, Material()).values() for one in row]
