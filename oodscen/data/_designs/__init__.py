"""Designs of things and movements made to order, and the geometry of their parts."""
