"""Claims: the statements of a text, one by one, and checks of a scene against them.

`oodscen.Augmenter.read` reads them, and `oodscen.Scene.check_claims` compares a scene with them.
"""
