"""The software renderer: from triangles to a camera's picture."""
