"""The land: roads' surfaces, terrain and islands."""
