"""Random streams keyed by purpose, so that removing one thing does not shift the others."""

import hashlib

import numpy as np

MAX_SEED = 2**63 - 1
"""Largest seed of a run; table columns and other programs can hold it."""


def stream(seed: int, *keys: object) -> np.random.Generator:
    """Return an independent generator for (seed, keys).

    Args:
        seed: The run's seed.
        keys: The purpose of the stream, e.g. `"actor", actor.id`; compared as text.
    """
    text = "\x1f".join(map(str, (seed, *keys)))
    digest = hashlib.sha256(text.encode()).digest()
    return np.random.Generator(np.random.PCG64(int.from_bytes(digest[:16], "little")))
