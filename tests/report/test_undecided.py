"""Scenes that tell no actions apart are listed with what was tried; models' words are text."""

from lxml import html

from oodscen.data._episode import ActionOutcome, Episode
from oodscen.report._load import Material
from oodscen.report._undecided import part
from oodscen.study import Study


def episode(name, *safe):
    actions = {a: ActionOutcome(safe=a in safe) for a in ("stop", "keep_speed")}
    return Episode(id=name, scene_id=name, status="ok", actions=actions)


def drawn(tmp_path, *episodes, lines=()):
    found = Material(episodes=list(episodes), restagings=list(lines))
    return html.fromstring(f"<div>{part(Study(tmp_path), found)}</div>")


def test_what_was_tried_is_said_for_every_undecided_scene(tmp_path):
    tried = [
        {"how": "decision time 2 -> 1", "why": "every action is safe"},
        {"how": "<script>faster</script>", "why": "it cannot be run: <b>"},
    ]
    page = drawn(
        tmp_path,
        episode("a-001", "stop", "keep_speed"),
        episode("b-001", "stop"),
        episode("c-001"),
        episode("c-001~twin"),
        lines=[{"id": "a-001", "how": "", "tried": tried}],
    )
    rows = [" ".join(row.itertext()) for row in page.xpath(".//tbody/tr")]
    assert len(rows) == 2
    assert "every action is safe" in rows[0]
    assert "decision time 2 -> 1" in rows[0]
    assert "<script>faster</script>" in rows[0]
    assert "no action is safe" in rows[1]
    assert "not on record" in rows[1]
    assert not page.xpath(".//script")


def test_without_such_scenes_there_is_no_part(tmp_path):
    assert not part(Study(tmp_path), Material(episodes=[episode("b-001", "stop")]))
