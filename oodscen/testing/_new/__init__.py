"""The package that `oodscen new adapter` writes: a simulator with dynamics of its own, and its tests.

The files of this folder are copied with the names replaced. `adapter.py` is also the example of
docs/adapters.md, and runs as it is.
"""
