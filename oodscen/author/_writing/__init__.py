"""Writing of texts and their ordinary twins."""
