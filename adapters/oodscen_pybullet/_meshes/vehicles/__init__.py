"""Meshes of the ego, of riders and of wrecks."""
