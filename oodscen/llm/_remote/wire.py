"""A request as it travels: messages, pictures and seeds."""

import base64
import re
from typing import Any

from oodscen.data._messages import Image, Message
from oodscen.errors import LLMError

_MARKS_CACHE = re.compile(r"anthropic|claude", re.IGNORECASE)
"""Models whose providers cache a prefix only where a request marks its end."""


def provider_seed(seed: int, sample: int, attempt: int = 1, repeat: int = 0) -> int:
    """Return the seed for one call to a provider: below 2**31, as some require.

    A repair or repetition has another seed than the question, since a model might otherwise repeat its fault word
    for word.
    """
    return (seed * 1_000_003 + sample + (attempt - 1) * 500_000_003 + repeat * 300_000_007) % 2**31


def wire_message(message: Message, model: str = "") -> dict[str, Any]:
    """Return a message in OpenAI's format; pictures become base64 data URLs.

    Raises:
        LLMError: When a picture cannot be read.
    """
    parts: list[dict[str, Any]] = [{"type": "text", "text": message.text}]
    if message.role == "system" and _MARKS_CACHE.search(model):
        # Other providers find repeated prefixes by themselves.
        parts[0]["cache_control"] = {"type": "ephemeral"}
    elif not message.images:
        return {"role": message.role, "content": message.text}
    for image in message.images:
        try:
            url = data_url(image)
        except OSError as error:
            reason = error.strerror or str(error)
            raise LLMError(f"cannot read the image {image.name}: {reason}", model=model) from error
        parts.append({"type": "image_url", "image_url": {"url": url}})
    return {"role": message.role, "content": parts}


def data_url(image: Image) -> str:
    """Return a picture as a data URL in its own format (JPEG or PNG)."""
    data = image.read()
    kind = "png" if data.startswith(b"\x89PNG") else "jpeg"
    return f"data:image/{kind};base64,{base64.b64encode(data).decode('ascii')}"
