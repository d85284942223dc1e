"""Meshes of objects: props, cargo, signs, plants."""
