"""Width and height of a JPEG or PNG file, as its header says, without decoding a pixel."""

_PNG = b"\x89PNG\r\n\x1a\n"
_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers of a JPEG frame header, which holds the size (ITU-T T.81, table B.1)."""
_BARE = frozenset({0x01, *range(0xD0, 0xD9)})
"""Markers without a length."""


def picture_size(data: bytes) -> tuple[int, int] | None:
    """Return width and height in pixels; `None` if no header of a JPEG or PNG file says them."""
    if data.startswith(_PNG):
        is_whole = data[12:16] == b"IHDR" and len(data) >= 24
        return (_number(data[16:20]), _number(data[20:24])) if is_whole else None
    at = 2
    while data.startswith(b"\xff\xd8") and at + 9 <= len(data) and data[at] == 0xFF:
        marker = data[at + 1]
        if marker in _FRAMES:
            return _number(data[at + 7 : at + 9]), _number(data[at + 5 : at + 7])
        if marker == 0xFF:  # Fill bytes may precede a marker.
            at += 1
        else:
            at += 2 if marker in _BARE else 2 + max(2, _number(data[at + 2 : at + 4]))
    return None


def _number(data: bytes) -> int:
    return int.from_bytes(data, "big")
