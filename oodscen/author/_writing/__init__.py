"""Writing texts and their ordinary twins."""
