"""The section of the report on tree coverage."""

from typing import TYPE_CHECKING

from markupsafe import Markup, escape

from oodscen.tree._coverage import LACKS, Coverage, Tally, coverage

if TYPE_CHECKING:
    from oodscen.report._load import Material
    from oodscen.study import Study

_HEADS = {
    "leaves": "Paths",
    "texts": "Texts",
    "scenes": "Scenes",
    "episodes": "Ran",
    "failed": "Failed",
    "safe": "Safe actions",
    "unsafe": "Unsafe actions",
    "mixed": "Choice matters",
    "holes": "Paths with a hole",
}
"""The headings of the counts in the table."""


def part(study: "Study", found: "Material") -> Markup:
    """Return counts per class and family of the simulatable tree, and the holes by leaf.

    Args:
        study: The study of the report.
        found: The material read from the study.
    """
    tree = found.trees.get("simulatable")
    if tree is None or not found.scenarios:
        return Markup("")
    return coverage_html(
        coverage(tree, texts=found.scenarios, scenes=found.scenes, episodes=found.episodes)
    )


def coverage_html(report: Coverage) -> Markup:
    """Return a coverage report as a table, followed by lists of holes; every label is escaped."""
    heads = Markup("").join(
        Markup('<th scope="col" class="n">{}</th>').format(head) for head in _HEADS.values()
    )
    rows = Markup("").join(_row(row) for row in report.rows if row.kind != "leaf")
    table = Markup(
        '<div class="scroll" role="region" aria-label="Coverage per family" tabindex="0"><table>'
        '<thead><tr><th scope="col">Branch</th>{}</tr></thead><tbody>{}</tbody></table></div>'
    ).format(heads, rows)
    return table + Markup("").join(_holes(report))


def _row(row: Tally) -> Markup:
    cells = Markup("").join(
        Markup('<td class="n">{}</td>').format(getattr(row, count)) for count in _HEADS
    )
    name = Markup("<bdi>{}</bdi>").format(row.label)
    name = name if row.depth > 1 else Markup("<strong>{}</strong>").format(name)
    return Markup('<tr><th scope="row">{}</th>{}</tr>').format(name, cells)


def _holes(report: Coverage) -> list[Markup]:
    found = []
    for lack, words in LACKS.items():
        labels = [row.label for row in report.holes if row.lacks == lack]
        if labels:
            items = Markup("").join(
                Markup("<li><bdi>{}</bdi></li>").format(label) for label in labels
            )
            found.append(
                Markup(
                    '<details class="fold"><summary>{} {} {}</summary><ul>{}</ul></details>'
                ).format(len(labels), "path" if len(labels) == 1 else "paths", escape(words), items)
            )
    return found
