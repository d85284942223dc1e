"""What can be asked of scenario trees: where a node comes from, how two differ, what is covered.

Importing the package loads nothing; each name below is imported when it is first used.
"""

from typing import TYPE_CHECKING

from oodscen._lazy import lazily

if TYPE_CHECKING:
    from oodscen.trees.comparison import Broadened, Moved, Placed, TreeDiff, diff
    from oodscen.trees.counts import Coverage, Tally, coverage, study_coverage
    from oodscen.trees.export import to_dot, to_mermaid, to_nested_json
    from oodscen.trees.history import replay
    from oodscen.trees.html import Remark, notebook_html, to_page, tree_html
    from oodscen.trees.matching import Match, match
    from oodscen.trees.origins import Decision, Provenance, provenance
    from oodscen.trees.union import merge
else:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "Broadened": "comparison",
            "Coverage": "counts",
            "Decision": "origins",
            "Match": "matching",
            "Moved": "comparison",
            "Placed": "comparison",
            "Provenance": "origins",
            "Remark": "html",
            "Tally": "counts",
            "TreeDiff": "comparison",
            "coverage": "counts",
            "diff": "comparison",
            "match": "matching",
            "merge": "union",
            "notebook_html": "html",
            "provenance": "origins",
            "replay": "history",
            "study_coverage": "counts",
            "to_dot": "export",
            "to_mermaid": "export",
            "to_nested_json": "export",
            "to_page": "html",
            "tree_html": "html",
        },
    )

__all__ = [
    "Broadened",
    "Coverage",
    "Decision",
    "Match",
    "Moved",
    "Placed",
    "Provenance",
    "Remark",
    "Tally",
    "TreeDiff",
    "coverage",
    "diff",
    "match",
    "merge",
    "notebook_html",
    "provenance",
    "replay",
    "study_coverage",
    "to_dot",
    "to_mermaid",
    "to_nested_json",
    "to_page",
    "tree_html",
]
