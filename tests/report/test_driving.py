"""The table of driving stacks: every driver, scenes and twins, whatever it is called."""

from lxml import html

from oodscen.data._drive_result import DriveResult
from oodscen.report._driving import part
from oodscen.report._load import Material
from oodscen.study import Study


def result(driver, name, **fields):
    return DriveResult(
        id=f"{name}@{driver}", scene_id=name, driver=driver, is_twin="~" in name, **fields
    )


def test_every_driver_has_a_row_for_scenes_and_one_for_twins(tmp_path):
    names = [f"leaf-{i % 6}-{i:03d}" for i in range(12)]
    drives = [
        result(driver, name + end, passed=True, progress=progress, peak_deceleration=1.0)
        for driver, progress in (("rule-based", 0.9), ("<b>still</b>:make", 0.05))
        for name in names
        for end in ("", "~twin")
    ]
    drives.append(result("broken", names[0], status="failed", error="no"))
    page = html.fromstring(f"<div>{part(Study(tmp_path), Material(drives=drives))}</div>")
    rows = [" ".join(row.itertext()) for row in page.xpath(".//tbody/tr")]
    assert len(rows) == 5
    assert "rule-based" in rows[0]
    assert "100 %" in rows[0]
    assert "<b>still</b>:make" in rows[2]
    assert "1 failed to run" in rows[4]
    assert "by hardly driving" in " ".join(page.itertext())
    heads, cells = len(page.xpath(".//thead//th")), [len(r) for r in page.xpath(".//tbody/tr")]
    assert set(cells) == {heads}


def test_without_drives_there_is_no_part(tmp_path):
    assert not part(Study(tmp_path), Material())
