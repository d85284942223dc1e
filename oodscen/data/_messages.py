"""Messages of a conversation, and the pictures in them."""

import hashlib
from pathlib import Path
from typing import Literal, Self

from pydantic import Field, PrivateAttr

from oodscen._io.files import read_bytes
from oodscen._io.picture_size import picture_size
from oodscen.data._base import Data
from oodscen.errors import UsageError

_BEGINS = (b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n")
_ENDS = (b"\xff\xd9", b"IEND\xaeB`\x82")


class Image(Data):
    """A named picture; the bytes of one in a file are loaded when a client sends it."""

    name: str
    """The picture's name in the study, e.g. `frames/x-003/first.jpg`."""
    sha256: str
    """SHA-256 of the encoded bytes."""
    path: Path | None = Field(default=None, exclude=True, repr=False)
    """File that holds the bytes; not part of the image's identity."""
    _content: bytes | None = PrivateAttr(default=None)
    """The bytes, if no file holds them."""

    @classmethod
    def from_file(cls, path: str | Path, name: str = "") -> Self:
        """Create a reference to a JPEG or PNG file; `fault` tells whether it can be shown.

        Raises:
            OSError: If it cannot be read.
        """
        path = Path(path)
        return cls(
            name=name or path.name, sha256=hashlib.sha256(read_bytes(path)).hexdigest(), path=path
        )

    @classmethod
    def from_bytes(cls, data: bytes, name: str) -> Self:
        """Create an image of the bytes of a JPEG or PNG, which need not be in a file.

        Raises:
            UsageError: If they are not.
        """
        image = cls(name=name, sha256=hashlib.sha256(data).hexdigest())
        image._content = data
        if fault := image.fault():
            raise UsageError(fault)
        return image

    def fault(self, size: tuple[int, int] | None = None) -> str:
        """Return why the JPEG or PNG file on disk cannot be shown, or an empty string.

        Args:
            size: Width and height that it must have, pixels; compared with its header, and nothing is decoded.
        """
        try:
            data = self.read()
        except OSError as error:
            return f"{self.name}: {error.strerror or error}"
        if not data.startswith(_BEGINS):
            return f"{self.name} is neither a JPEG nor a PNG"
        if not data.endswith(_ENDS):
            return f"{self.name} is cut off before its end"
        if size is None or (found := picture_size(data)) == size:
            return ""
        told = "an unknown size" if found is None else f"{found[0]} x {found[1]} pixels"
        return f"{self.name} has {told}, not the {size[0]} x {size[1]} of the camera"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Image) and (self.name, self.sha256) == (other.name, other.sha256)

    def __hash__(self) -> int:
        return hash((self.name, self.sha256))

    def read(self) -> bytes:
        """Return the encoded bytes."""
        if self._content is not None:
            return self._content
        if self.path is None:
            raise FileNotFoundError(f"no file is known for the image {self.name}")
        return read_bytes(self.path)


class Message(Data):
    """One message of a conversation."""

    role: Literal["system", "user", "assistant"]
    text: str
    images: tuple[Image, ...] = ()
