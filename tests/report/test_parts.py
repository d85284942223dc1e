from collections.abc import Callable

import pytest
from markupsafe import Markup

from oodscen.pruning.comparing import Comparison, Line, Side, Tally
from oodscen.pruning.restoring import Restoration
from oodscen.report import parts
from oodscen.report.further import (
    CATALOGUES,
    comparison_part,
    restoration_part,
    saturation_part,
)
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


def test_a_comparison_of_catalogues_is_shown_where_the_study_holds_one(study: Study) -> None:
    found = read(study)
    assert comparison_part(study, found) == ""
    empty = Restoration(kept=0, dropped=0, single=(), categories=(), sequence=(), beyond=())
    names = ("here", "there")
    compared = Comparison(
        catalogues=names,
        tallies=tuple(
            Tally(
                catalogue=name, kept=1, full=1, substitute=0, part=0, dropped=0, failed=0, alone=0,
                absent=(), restoration=empty,
            )
            for name in names
        ),
        lines=(
            Line(
                id="dog",
                path=("Root", "Interactional", "A <b>dog</b>"),
                sides=tuple(Side(keep=True, match=None, reason="<script>") for _ in names),
            ),
        ),
    )  # fmt: skip
    study.store.write(CATALOGUES, compared.to_json())
    markup = comparison_part(study, found)
    assert "A &lt;b&gt;dog&lt;/b&gt;" in markup
    assert "<script>" not in markup
    study.store.write(CATALOGUES, "[]")
    errors = [one.error for one in drawn(study, found)["pruning"]]
    assert any(errors)
