"""Meshes of vehicles and riders."""
