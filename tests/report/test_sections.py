from collections.abc import Callable

import pytest
from markupsafe import Markup

from oodscen.errors import DataError, Issue
from oodscen.report import _sections as parts
from oodscen.report._gaps import restoration_part, saturation_part
from oodscen.report._load import Material, read
from oodscen.report._sections import Drawn, Part, drawn
from oodscen.study import Study


def hello(study: Study, found: Material) -> Markup:
    return Markup("<p>{}</p>").format(len(found.scenarios))


def unreadable(study: Study, found: Material) -> Markup:
    raise DataError("study", [Issue("rows[3]", "nothing fits")])


def mistaken(study: Study, found: Material) -> Markup:
    raise KeyError("a slip of the pen")


def test_a_broken_file_is_a_note_in_its_place(
    study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = (Part("metrics", "Good", hello), Part("metrics", "Bad", unreadable))
    monkeypatch.setattr(parts, "PARTS", here)
    good, bad = drawn(study, read(study))["metrics"]
    assert good == Drawn("Good", Markup("<p>6</p>"))
    assert (bad.title, bad.markup) == ("Bad", "")
    assert "rows[3]: nothing fits" in bad.error


def test_a_mistake_in_the_code_is_no_note(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parts, "PARTS", (Part("metrics", "Bad", mistaken),))
    with pytest.raises(KeyError):
        drawn(study, read(study))


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
