"""Traces of OSI ground truth in MCAP files, with the road and the message types."""

import io
from collections.abc import Iterator
from functools import cache
from operator import itemgetter
from typing import Any

from lxml import etree

from oodscen.errors import DataError, Issue, MissingExtra
from oodscen.interchange._writing.roads import RoadFile

OSI_VERSION = "3.7.0"
"""Version of OSI whose message types the files name."""
TRUTH, ROAD = "osi3.GroundTruth", "osi3.MapAsamOpenDrive"
_TOPICS = {TRUTH: "ground_truth", ROAD: "ground_truth_map"}
"""Topics by message type, as omega-prime has them."""
_CREATION_TIME = "2026-01-01T00:00:00Z"
"""Creation time in every file: the same run gives the same bytes."""
_MAGIC = b"\x89MCAP0\r\n"
"""First and last bytes of a file."""
_MAX_RECORD_BYTES = 256 * 1024 * 1024
_NOUN = "MCAP trace"


def mcap_trace(messages: Iterator[tuple[int, bytes]], road: RoadFile) -> bytes:
    """Return the ground truth of every step, its time in ns and its message, and the road as an MCAP file.

    Raises:
        MissingExtra: If the packages for MCAP are not installed.
    """
    betterosi = mcap_library()
    from mcap.writer import Writer

    out = io.BytesIO()
    writer = Writer(out)
    writer.start(library="oodscen")
    metadata = betterosi.io.prepare_required_file_metadata(
        {"creation_time": _CREATION_TIME}, OSI_VERSION
    )
    writer.add_metadata(betterosi.io.OSI_TRACE_METADATA_NAME, metadata)
    channel_metadata = betterosi.io.prepare_channel_metadata(version=OSI_VERSION)
    channels = {}
    for kind, topic in _TOPICS.items():
        schema = writer.register_schema(kind, "protobuf", _message_types(kind))
        channels[kind] = writer.register_channel(topic, "protobuf", schema, channel_metadata)
    road_message = betterosi.MapAsamOpenDrive(
        map_reference=road.name, open_drive_xml_content=_xml_text(road.content)
    )
    writer.add_message(channels[ROAD], 0, road_message.to_binary(), 0)
    for time_ns, message in messages:
        writer.add_message(channels[TRUTH], time_ns, message, time_ns)
    writer.finish()
    return out.getvalue()


def _xml_text(content: bytes) -> str:
    """Return an XML file as text; one in another encoding gets a declaration of UTF-8."""
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        root = etree.fromstring(content, etree.XMLParser(resolve_entities=False, no_network=True))
        return etree.tostring(root, encoding="UTF-8", xml_declaration=True).decode()


def mcap_messages(data: bytes, source: str) -> list[bytes]:
    """Return the encoded messages of ground truth in an MCAP file, in the order of time.

    They are those of the topic `ground_truth`, or of the only topic that has some.

    Raises:
        DataError: If the bytes are not an MCAP file, or several other topics have ground truth.
        MissingExtra: If the packages for MCAP are not installed.
    """
    mcap_library()
    if not data.startswith(_MAGIC):
        raise _fault("is not an MCAP file", source)
    if not data.endswith(_MAGIC):
        raise _fault("is cut off: MCAP files end as they begin", source)
    try:
        is_too_large = _largest_chunk_bytes(data) > _MAX_RECORD_BYTES
        topics = {} if is_too_large else _topics(data)
    except Exception:
        # The reader lets errors of several packages through, in words of their own.
        raise _fault("is damaged: a record of the MCAP file cannot be read", source) from None
    if is_too_large:
        raise _fault(f"a chunk has more than {_MAX_RECORD_BYTES >> 20} MiB", source)
    usual = _TOPICS[TRUTH]
    if usual not in topics and len(topics) > 1:
        names = ", ".join(sorted(topics))
        raise _fault(f"has ground truth in the topics {names}, and none is {usual!r}", source)
    timed = topics.get(usual) or next(iter(topics.values()), [])
    return [message for _, message in sorted(timed, key=itemgetter(0))]


def _largest_chunk_bytes(data: bytes) -> int:
    """Return the size of the largest chunk when unpacked, in bytes."""
    from mcap.records import Chunk
    from mcap.stream_reader import StreamReader

    reader = StreamReader(io.BytesIO(data), emit_chunks=True, record_size_limit=_MAX_RECORD_BYTES)
    sizes = (record.uncompressed_size for record in reader.records if isinstance(record, Chunk))
    return max(sizes, default=0)


def _topics(data: bytes) -> dict[str, list[tuple[int, bytes]]]:
    """Return times in ns and messages of ground truth by topic; the summary may lack schemas and channels."""
    from mcap.reader import NonSeekingReader

    reader = NonSeekingReader(
        io.BytesIO(data), validate_crcs=True, record_size_limit=_MAX_RECORD_BYTES
    )
    topics: dict[str, list[tuple[int, bytes]]] = {}
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        if schema is not None and schema.name == TRUTH:
            topics.setdefault(channel.topic, []).append((message.log_time, message.data))
    return topics


def _fault(message: str, source: str) -> DataError:
    return DataError(_NOUN, [Issue("", message)], source=source)


def mcap_library() -> Any:
    """Return the package that writes MCAP files.

    Raises:
        MissingExtra: If it is not installed.
    """
    try:
        import betterosi
        import betterosi.io
    except ImportError:
        raise MissingExtra("OSI in MCAP", "osi", "betterosi") from None
    return betterosi


@cache
def _message_types(kind: str) -> bytes:
    """Return the description of a message type and of all that it contains, without comments."""
    import betterosi.io
    from protobuf.wkt import FileDescriptorSet

    every_file = FileDescriptorSet.from_binary(betterosi.io.load_descriptor_set(OSI_VERSION)).file
    files = {file.name: file for file in every_file}
    package, _, type_name = kind.partition(".")
    needed = [
        file.name
        for file in every_file
        if file.package == package
        and any(message.name == type_name for message in file.message_type)
    ]
    for name in needed:  # It grows by the files on which these depend.
        needed += [other for other in files[name].dependency if other not in needed]
    for file in every_file:
        file.source_code_info = None
    selected = [file for file in every_file if file.name in needed]
    encoded: bytes = FileDescriptorSet(file=selected).to_binary()
    return encoded
