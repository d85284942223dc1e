"""Checks of a scene before it runs: placement, visibility and the content of its key moments."""
