"""The stages in data-flow order: grow, red-team, prune, describe, augment, simulate, evaluate.

Their public names are in `oodscen`; pictures, videos and annotations are methods of a `Scene`.
"""
