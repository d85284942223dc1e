"""Parts of the page about kinds still to be found and about restoring pruned paths."""

from markupsafe import Markup

from oodscen.report._charts.saturation import saturation_chart
from oodscen.report._load import Material
from oodscen.stages._prune.restoration import restoration, restoration_rows
from oodscen.stages._redteam.saturation import saturation
from oodscen.study import Study

_MOST_ADDITIONS = 15


def saturation_part(study: Study, found: Material) -> Markup:
    """Draw the new kinds found by the rounds of red teaming, and estimate those left."""
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
    """Rank the single additions to the catalogue by the number of pruned paths each restores."""
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
