"""Random streams keyed by what they are for, so that removing one thing shifts nothing else."""

import hashlib

import numpy as np

MAX_SEED = 2**63 - 1
"""Largest seed of a run: what columns of tables and other programs can hold."""


def stream(seed: int, *keys: object) -> np.random.Generator:
    """Return a generator of its own for (seed, keys).

    Args:
        seed: The run's seed.
        keys: What the stream is for, e.g. `"actor", actor.id`; compared by their text.
    """
    text = "\x1f".join(map(str, (seed, *keys)))
    digest = hashlib.sha256(text.encode()).digest()
    return np.random.Generator(np.random.PCG64(int.from_bytes(digest[:16], "little")))
