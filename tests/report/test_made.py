"""The part of the page about what was made to order: designs, movements, printed texts, details."""

from lxml import html

from oodscen import Study
from oodscen._io.study_files import picture_of
from oodscen.data._designs.prop import Prop
from oodscen.data._episode import Episode
from oodscen.data._scene import Scene
from oodscen.report._gallery import payload
from oodscen.report._load import Material
from oodscen.report._made import made_to_order
from oodscen.report._render import render_part
from oodscen.report._sections import RenderedPart
from oodscen.stages._making.looking import DISTANCES_M, UNSEEN, PropLook, PropView
from oodscen.stages._making.making import MadeProp
from oodscen.stages._making.motions import MadeMotion
from tests.made import WALL
from tests.motions import TOPPLE

QUAD = [[-0.21, 0.5, 0.2], [-0.21, -0.5, 0.2], [-0.21, -0.5, 0.8], [-0.21, 0.5, 0.8]]
SIGNED = Prop.parse({**WALL, "parts": [*WALL["parts"], {"text": "EAT FISH", "on": QUAD}]})
LOOK = PropLook(
    id="low_wall",
    views=tuple(
        PropView(distance_m=distance, is_night=night, pixels=round(90_000 / distance), contrast=50)
        for night in (False, True)
        for distance in DISTANCES_M
    ),
)


def scene(name="s-001", **fields):
    return Scene.parse(
        {
            "id": name,
            "scenario_id": name,
            "map": "urban_three_lane",
            "ego": {"speed": 8},
            "weather": {"sun_elevation_deg": -20},
            "actors": [
                {
                    "id": "wall",
                    "asset": "low_wall",
                    "placement": {"ahead_m": 40},
                    "behaviour": {"name": "topple", "trigger": {"kind": "time", "value": 1}},
                },
                {
                    "id": "lorry",
                    "asset": "truck",
                    "placement": {"ahead_m": 60},
                    "details": {"text": "ICE", "parts": ["doors_open"], "colour": "dark_grey"},
                },
            ],
            "hazard": {"actors": {"wall": None}},
            "decision": {"kind": "distance", "value": 25, "actor": "wall"},
            "made": [SIGNED.model_dump()],
            "motions": [TOPPLE],
            "map_state": {"street_lamps": "off"},
            **fields,
        }
    )


def shown(folder, found):
    rows = made_to_order(Study(folder), found)
    return html.fromstring(f"<div>{render_part(RenderedPart('', 'made', rows))}</div>")


def test_everything_that_was_made_is_on_the_page(tmp_path):
    (tmp_path / "assets").mkdir()
    (tmp_path / picture_of("low_wall")).write_bytes(b"\xff\xd8")
    found = Material(
        scenes=[scene("s-001"), scene("s-002")],
        assets=[
            MadeProp(id="low_wall", prop=SIGNED, look=LOOK),
            MadeProp(id="ghost", reason="<b>cannot be seen</b>"),
        ],
        motions=[MadeMotion(id="topple", motion=scene().motions[0])],
    )
    page = shown(tmp_path, found)
    assert page.xpath(".//img/@src") == ["assets/low_wall.jpg"]
    told = " ".join(" ".join(page.itertext()).split())
    for words in (
        WALL["description"],
        UNSEEN,
        "9,000 · 6,000 · 3,000",
        "EAT FISH",
        "ICE",
        TOPPLE["description"],
        "a loose thing",
        "doors open, painted dark grey",
        "street lamps: off",
        "<b>cannot be seen</b>",
    ):
        assert words in told
    assert not page.xpath(".//b[. = 'cannot be seen']")
    assert len(page.xpath(".//a[@href = '#scene-s-002']")) >= 4


def test_a_printed_text_has_the_scenes_of_every_design_that_bears_it(tmp_path):
    heavier = SIGNED.model_copy(update={"mass_kg": SIGNED.mass_kg + 1.0})
    unused = MadeProp(id="spare", prop=SIGNED.model_copy(update={"id": "spare"}))
    scenes = [scene("s-001"), scene("s-002", made=[heavier.model_dump()])]
    found = made_to_order(Study(tmp_path), Material(scenes=scenes, assets=[unused]))
    assert {row: uses.scenes for row, uses in found["printed"].items()} == {
        ("ICE", "truck"): ["s-001", "s-002"],
        ("EAT FISH", "low wall"): ["s-001", "s-002"],
    }


def test_designs_that_only_scenes_carry_are_shown_as_they_are_there(tmp_path):
    (tmp_path / "frames").mkdir()
    (tmp_path / "frames" / "last.jpg").write_bytes(b"\xff\xd8")
    ran = Episode(id="s-001", scene_id="s-001", status="ok", frames={"last": "frames/last.jpg"})
    page = shown(tmp_path, Material(scenes=[scene()], episodes=[ran]))
    assert page.xpath(".//img/@src") == ["frames/last.jpg"]
    assert not shown(tmp_path, Material(scenes=[scene()])).xpath(".//img")


def test_where_nothing_was_made_there_is_no_part(tmp_path):
    plain = scene(
        actors=[{"id": "wall", "asset": "cone", "placement": {"ahead_m": 40}}],
        made=(),
        motions=(),
        map_state=None,
    )
    assert made_to_order(Study(tmp_path), Material(scenes=[plain])) is None


def test_a_scene_says_what_is_made_and_what_is_out_of_order(tmp_path):
    (row,) = payload(Material(scenes=[scene()]), tmp_path)["scenes"]
    wall, lorry = row["players"]
    assert WALL["description"] in wall["what"]
    assert f"{TOPPLE['description']} (made to order)" in wall["what"]
    assert "“ICE” on its sides" in lorry["name"]
    assert "street lamps: off" in row["setting"]
