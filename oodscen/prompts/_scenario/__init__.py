"""Questions that write, read and stage texts."""
