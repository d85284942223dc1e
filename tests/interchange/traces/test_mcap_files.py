import io
import re
import struct
from functools import cache

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from oodscen.errors import DataError, UnknownComponent
from oodscen.interchange._traces.mcap_files import mcap_trace
from oodscen.interchange._traces.osi_reading import read_osi_trace
from oodscen.interchange._traces.osi_writing import osi_trace
from oodscen.interchange._writing.roads import RoadFile, road_file
from tests.interchange.staging import SCENES, catalogue

SCENE = SCENES[0]


@cache
def mcap():
    pytest.importorskip("betterosi")
    return osi_trace(SCENE, catalogue(), container="mcap")


def test_both_containers_hold_the_same_messages():
    packed, plain = mcap(), osi_trace(SCENE, catalogue())
    found = list(read_osi_trace(packed, "run.mcap"))
    assert found == list(read_osi_trace(plain, "run.osi"))
    assert {row.name for row in found} == {"ego", *(actor.id for actor in SCENE.actors)}
    assert packed == osi_trace(SCENE, catalogue(), container="mcap")


def test_the_published_library_reads_the_messages_and_the_road(tmp_path):
    betterosi = pytest.importorskip("betterosi")
    path = tmp_path / "run.mcap"
    path.write_bytes(mcap())
    first = next(iter(betterosi.read(path, return_ground_truth=True)))
    assert len(first.moving_object) == 1 + len(SCENE.actors)
    ego = first.moving_object[0].base
    assert ego.velocity.x**2 + ego.velocity.y**2 == pytest.approx(SCENE.ego.speed**2, rel=1e-3)
    road = road_file(SCENE, catalogue())
    (held,) = betterosi.read(path, mcap_topics=["ground_truth_map"])
    assert held.open_drive_xml_content.encode() == road.content


@pytest.mark.parametrize("encoding", ["UTF-8", "utf-8-sig", "ISO-8859-1", "UTF-16"])
def test_a_road_in_any_encoding_is_held_as_text(encoding, tmp_path):
    betterosi = pytest.importorskip("betterosi")
    declared = encoding.removesuffix("-sig")
    declaration = f"<?xml version='1.0' encoding='{declared}'?>"
    text = f"{declaration}<OpenDRIVE><road name='Hauptstra\u00dfe'/></OpenDRIVE>"
    path = tmp_path / "run.mcap"
    road = RoadFile("road.xodr", text.encode(encoding))
    path.write_bytes(mcap_trace(iter([]), road))
    (held,) = betterosi.read(path, mcap_topics=["ground_truth_map"])
    content = held.open_drive_xml_content
    assert content.startswith("<?xml")
    assert etree.fromstring(content.encode())[0].get("name") == "Hauptstra\u00dfe"


@pytest.mark.parametrize("cut", [0, 1, 9, 5_000, -1, -40])
def test_what_is_cut_off_is_refused(cut):
    whole = mcap()
    with pytest.raises(DataError, match=r"not an MCAP file|cut off"):
        list(read_osi_trace(whole[:cut], "run.mcap"))


@given(st.data())
@settings(max_examples=30)
def test_a_changed_file_is_read_or_refused_in_plain_words(data):
    whole = mcap()
    place = data.draw(st.integers(8, len(whole) - 16))
    changed = whole[:place] + data.draw(st.binary(max_size=8)) + whole[place + 8 :]
    try:
        list(read_osi_trace(changed, "run.mcap"))
        said = ""
    except DataError as error:
        said = error.issues[0].message
    assert re.match("$|is damaged|a chunk has more than|cannot be read as ground truth", said)


def test_messages_that_are_no_ground_truth_are_refused():
    pytest.importorskip("betterosi")
    data = mcap_trace(
        iter([(0, b"\x0b"), (1, struct.pack("<I", 7))]), road_file(SCENE, catalogue())
    )
    with pytest.raises(DataError):
        list(read_osi_trace(data, "run.mcap"))


def test_an_unknown_container_is_refused():
    with pytest.raises(UnknownComponent):
        osi_trace(SCENE, catalogue(), container="zip")


def rewritten(*topics, shift_ns=0, **options):
    """Return the file with its ground truth in other topics; those of later ones come later."""
    from mcap.reader import make_reader
    from mcap.writer import Writer

    out = io.BytesIO()
    writer = Writer(out, **options)
    writer.start()
    messages = list(make_reader(io.BytesIO(mcap())).iter_messages(["ground_truth"]))
    schema = writer.register_schema(messages[0][0].name, "protobuf", messages[0][0].data)
    for index, topic in enumerate(topics):
        channel = writer.register_channel(topic, "protobuf", schema)
        for _, _, message in messages[: 5 if index else None]:
            at = message.log_time + index * shift_ns
            writer.add_message(channel, at, message.data, at)
    writer.finish()
    return out.getvalue()


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"repeat_channels": False},
        {"repeat_schemas": False},
        {"use_statistics": False, "use_summary_offsets": False},
        {"use_chunking": False},
        {"chunk_size": 500},
    ],
)
def test_files_of_other_writers_are_read(options):
    own = list(read_osi_trace(mcap(), "run.mcap"))
    assert list(read_osi_trace(rewritten("lab", **options), "run.mcap")) == own


def test_one_topic_with_ground_truth_is_read():
    own = list(read_osi_trace(mcap(), "run.mcap"))
    both = rewritten("prediction", "ground_truth", shift_ns=25_000_000)
    assert list(read_osi_trace(both, "run.mcap")) == own[: 5 * len({row.name for row in own})]
    with pytest.raises(DataError, match="topics lab, prediction, and none is 'ground_truth'"):
        list(read_osi_trace(rewritten("prediction", "lab"), "run.mcap"))
