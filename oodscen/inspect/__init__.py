"""Tasks for inspect_ai: `oodscen/notice`, `oodscen/name`, `oodscen/choose` and `oodscen/act`.

inspect_ai finds them by its registry; there is nothing to import from here.
"""
