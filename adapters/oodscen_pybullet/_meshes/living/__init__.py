"""Meshes of people and animals."""
