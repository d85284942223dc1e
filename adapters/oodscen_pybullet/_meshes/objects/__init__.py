"""Meshes of things: props, cargo, signs, plants, road works."""
