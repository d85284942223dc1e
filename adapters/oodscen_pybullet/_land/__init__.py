"""The land: road surfaces, terrain and islands."""
