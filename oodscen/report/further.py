"""Parts of the page about what is left to be found, and what would bring pruned paths back."""

from markupsafe import Markup

from oodscen.pruning.comparing import Comparison
from oodscen.pruning.restoring import restoration, restoration_rows
from oodscen.redteaming.saturation import saturation
from oodscen.report.reading import Material, printable
from oodscen.report.saturation import saturation_chart
from oodscen.study import Study

CATALOGUES = "catalogues.json"
"""File of a study with a comparison of catalogues, where one was made."""
_MOST_ADDITIONS = 15


def saturation_part(study: Study, found: Material) -> Markup:
    """Draw how many new kinds the rounds of red teaming brought, and estimate what is left."""
    chart = saturation_chart(estimates := saturation(found.rounds))
    if not chart:
        return Markup("")
    return Markup(
        '<figure class="chart-box">{}<figcaption>Solid: new kinds so far, {} in all. Dotted: the '
        "estimated chance that the next one is of a kind already met. About {} more kinds are "
        "estimated to be unseen, {} to {}.</figcaption></figure>"
    ).format(
        chart,
        estimates.kinds,
        *map(round, (estimates.unseen, estimates.unseen_low, estimates.unseen_high)),
    )


def restoration_part(study: Study, found: Material) -> Markup:
    """Rank the single additions to the catalogue by how many pruned paths each brings back."""
    ranking = restoration(found.decisions)
    labels = {one.id: one.path[-1] if one.path else one.id for one in found.decisions}
    rows = restoration_rows(ranking, labels, limit=_MOST_ADDITIONS)
    if not rows:
        return Markup("")
    lines = [
        Markup(
            '<tr><th scope="row"><bdi>{}</bdi></th><td class="n">{}</td><td class="n">{}</td>'
            "<td><bdi>{}</bdi></td></tr>"
        ).format(row["addition"], row["paths"], row["helps"], row["labels"])
        for row in rows
    ]
    return Markup(
        "<p>The catalogue shows {} of {} paths. Additions, by how many of the others each brings back "
        "alone; “helps” counts the paths that need something else as well.</p>"
        '<details class="fold"><summary>{} additions</summary><div class="scroll" role="region" '
        'aria-label="What would bring paths back" tabindex="0"><table class="plainer"><thead><tr>'
        '<th scope="col">Addition</th><th scope="col" class="n">Brings back</th>'
        '<th scope="col" class="n">Helps</th><th scope="col">Paths</th></tr></thead>'
        "<tbody>{}</tbody></table></div></details>"
    ).format(ranking.kept, ranking.kept + ranking.dropped, len(rows), Markup("").join(lines))


def comparison_part(study: Study, found: Material) -> Markup:
    """Show what several simulators make of the diverse tree, where the study holds `catalogues.json`.

    It is what `oodscen prune TREE --catalogue A --catalogue B --json` prints.

    Raises:
        DataError: When the file holds something else.
    """
    if not study.store.has(CATALOGUES):
        return Markup("")
    compared = Comparison.load(study.folder / CATALOGUES)
    heads = Markup("").join(
        Markup('<th scope="col"><bdi>{}</bdi></th>').format(name) for name in compared.catalogues
    )
    tallies = Markup("").join(
        Markup(
            '<tr><th scope="row"><bdi>{}</bdi></th><td class="n">{}</td><td class="n">{}</td>'
            '<td class="n">{}</td><td class="n">{}</td></tr>'
        ).format(one.catalogue, one.kept, one.substitute, one.alone, one.dropped)
        for one in compared.tallies
    )
    rows = Markup("").join(
        Markup('<tr><th scope="row"><bdi>{}</bdi></th>{}</tr>').format(
            row["branch"],
            Markup("").join(
                Markup("<td><bdi>{}</bdi></td>").format(row[name]) for name in compared.catalogues
            ),
        )
        for row in printable(compared.rows())
    )
    return Markup(
        '<div class="scroll" role="region" aria-label="Simulators in figures" tabindex="0">'
        '<table class="plainer narrow"><thead><tr><th scope="col">Simulator</th>'
        '<th scope="col" class="n">Shows</th><th scope="col" class="n">with substitutes</th>'
        '<th scope="col" class="n">only it shows</th><th scope="col" class="n">Drops</th></tr></thead>'
        '<tbody>{}</tbody></table></div><details class="fold"><summary>All {} paths</summary>'
        '<div class="scroll" role="region" aria-label="Simulators path by path" tabindex="0">'
        '<table class="rounds"><thead><tr><th scope="col">Path</th>{}</tr></thead><tbody>{}</tbody>'
        "</table></div></details>"
    ).format(tallies, len(compared.lines), heads, rows)
