"""The part of the page that compares the study's simulator with others."""

from markupsafe import Markup

from oodscen.report._load import Material, printable
from oodscen.stages._prune.side_by_side import Comparison, Side, Tally
from oodscen.study import Study
from oodscen.study._study import CATALOGUES

_KINDS = {
    "vehicle": "vehicles",
    "cyclist": "cyclists",
    "pedestrian": "pedestrians",
    "animal": "animals",
    "object": "loose objects",
    "work_zone": "things of road works",
    "vegetation": "plants or fallen trees",
    "signal": "signals",
}
"""Names of the kinds that a catalogue lacks entirely."""


def part(study: Study, found: Material) -> Markup:
    """Show which paths of the diverse tree each simulator can simulate, from `catalogues.json`.

    `oodscen prune TREE --catalogue A --catalogue B --json` prints that file. If a study lacks it, the page
    explains how to get it.

    Raises:
        DataError: If the file holds something else.
    """
    if not study.store.has(CATALOGUES):
        return _how(found)
    compared = Comparison.load(study.folder / CATALOGUES)
    first, *others = compared.tallies
    return Markup("{}{}{}{}").format(
        Markup("").join(_sentence(one, first) for one in others),
        _figures(compared),
        Markup("").join(_dropped(compared, number) for number in range(1, len(compared.tallies))),
        _everything(compared),
    )


def _how(found: Material) -> Markup:
    if not {"diverse", "simulatable"} <= set(found.trees):
        return Markup("")
    return Markup(
        '<p class="note">Not asked: the model that judged the branches would have to be asked about '
        "another simulator as well, which costs calls. To ask it: <code>oodscen prune "
        "FOLDER/tree.diverse.json --llm {} --catalogue {} --catalogue carla-0.9.16 --json -o "
        "FOLDER/{}</code>, then <code>oodscen report FOLDER</code>.</p>"
    ).format(
        found.config.get("llm") or "NAME", found.config.get("simulator") or "SIMULATOR", CATALOGUES
    )


def _sentence(tally: Tally, first: Tally) -> Markup:
    """Describe the part of the tree that one simulator shows, and the kinds that it lacks entirely."""
    total = tally.kept + tally.dropped
    text = Markup(
        "<p>Of the {} paths of the diverse tree <bdi>{}</bdi> shows {} and <bdi>{}</bdi> {}; it drops "
        "the other {}."
    ).format(total, first.catalogue, first.kept, tally.catalogue, tally.kept, tally.dropped)
    if tally.absent:
        kinds = [_kind(name, tally) for name in tally.absent]
        listed = kinds[0] if len(kinds) == 1 else f"{', '.join(kinds[:-1])} and {kinds[-1]}"
        text += Markup(" <strong><bdi>{}</bdi> has {} at all.</strong>").format(
            tally.catalogue, listed
        )
    if tally.failed:
        text += Markup(" The model could not be asked about {}.").format(tally.failed)
    return text + Markup("</p>")


def _kind(name: str, tally: Tally) -> str:
    """Name an absent kind, and the number of dropped paths that need it."""
    ranking = tally.restoration
    needed = sum(one.helps for one in ranking.categories if one.category == name)
    for one in ranking.single:
        needed += sum(a.kind == "weather" and a.name == name for a in one.additions) and one.helps
    text = f"no {_KINDS.get(name, name)}"
    return f"{text} (needed by {needed} of the dropped)" if needed else text


def _figures(compared: Comparison) -> Markup:
    rows = Markup("").join(
        Markup(
            '<tr><th scope="row"><bdi>{}</bdi></th><td class="n">{}</td><td class="n">{}</td>'
            '<td class="n">{}</td><td class="n">{}</td><td class="n">{}</td><td class="n">{}</td></tr>'
        ).format(
            one.catalogue, one.kept, one.full, one.part, one.substitute, one.dropped, one.alone
        )
        for one in compared.tallies
    )
    return Markup(
        '<div class="scroll" role="region" aria-label="Simulators in figures" tabindex="0">'
        '<table class="plainer narrow"><thead><tr><th scope="col">Simulator</th>'
        '<th scope="col" class="n">Shows</th><th scope="col" class="n">as it is</th>'
        '<th scope="col" class="n">in part</th><th scope="col" class="n">with stand-ins</th>'
        '<th scope="col" class="n">Drops</th><th scope="col" class="n">only it shows</th></tr></thead>'
        "<tbody>{}</tbody></table></div>"
        '<p class="note">“In part”: the label is narrowed to what can be shown. “With stand-ins”: near '
        "relations are shown instead; the study itself drops such paths, since its scenes must have what "
        "their texts name.</p>"
    ).format(rows)


def _dropped(compared: Comparison, number: int) -> Markup:
    """List the paths that one simulator drops, with the reasons and the study's own decisions."""
    name, first = compared.catalogues[number], compared.catalogues[0]
    lines = [line for line in compared.lines if not line.sides[number].keep]
    if not lines:
        return Markup("")
    rows = [
        {
            "path": " › ".join(line.path[1:]),
            "reason": line.sides[number].reason,
            "first": _fate(line.sides[0]),
        }
        for line in lines
    ]
    cells = Markup("").join(
        Markup(
            '<tr><th scope="row"><bdi>{path}</bdi></th><td><bdi>{reason}</bdi></td>'
            "<td><bdi>{first}</bdi></td></tr>"
        ).format(**row)
        for row in printable(rows)
    )
    return Markup(
        '<details class="fold"><summary>{} paths that <bdi>{}</bdi> does not show, and why</summary>'
        '<div class="scroll" role="region" aria-label="Paths that {} drops" tabindex="0">'
        '<table class="rounds"><thead><tr><th scope="col">Path</th><th scope="col">Why not</th>'
        '<th scope="col">Shown by <bdi>{}</bdi></th></tr></thead><tbody>{}</tbody></table></div></details>'
    ).format(len(lines), name, name, first, cells)


def _fate(side: Side) -> str:
    words = {"full": "yes", "substitute": "with stand-ins", "part": "in part", "none": "no"}
    text = words[side.match] if side.match else "not judged"
    return f"{text}: {side.label}" if side.label else text


def _everything(compared: Comparison) -> Markup:
    heads = Markup("").join(
        Markup('<th scope="col"><bdi>{}</bdi></th>').format(name) for name in compared.catalogues
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
        '<details class="fold"><summary>All {} paths, side by side</summary>'
        '<div class="scroll" role="region" aria-label="Simulators path by path" tabindex="0">'
        '<table class="rounds"><thead><tr><th scope="col">Path</th>{}</tr></thead><tbody>{}</tbody>'
        "</table></div></details>"
    ).format(len(compared.lines), heads, rows)
