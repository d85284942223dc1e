"""The part of the page about undecidable scenes, in which all actions or none are safe, and attempted fixes."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

from markupsafe import Markup

from oodscen.data._sighting import TO_NAME
from oodscen.report._load import Material
from oodscen.study import Study

_MOST = 200
"""The most scenes that are listed."""


def part(study: Study, found: Material) -> Markup:
    """List the scenes in which every action, or none, is safe; empty if there are none."""
    undecided = [
        one
        for one in found.episodes
        if one.status == "ok" and not one.is_twin and one.actions and not one.is_decidable
    ]
    if not undecided:
        return Markup("")
    told = {str(line.get("id")): line for line in found.restagings}
    restaged = sum(
        bool(one.restaged) and not one.restaged.startswith(TO_NAME) for one in found.episodes
    )
    rows = Markup("").join(
        Markup(
            '<tr><th scope="row"><a href="#scene-{}"><bdi>{}</bdi></a></th><td>{}</td><td>{}</td></tr>'
        ).format(
            one.scene_id,
            one.scene_id,
            "every action is safe" if one.safe_set else "no action is safe",
            _tried(told.get(one.scene_id)),
        )
        for one in undecided[:_MOST]
    )
    return Markup(
        "<p>In {} scenes every action that can be executed is safe, or none is: they say nothing about a choice. {} "
        "others were like that and were staged anew, so that the choice matters; for these nothing that was tried "
        "helped.</p>"
        '<details class="fold"><summary>Which, and what was tried <span class="aside">{}</span></summary>'
        '<div class="scroll" role="region" aria-label="Scenes that tell no actions apart" tabindex="0">'
        '<table class="rounds"><thead><tr><th scope="col">Scene</th><th scope="col">As it is</th>'
        '<th scope="col">Tried in vain</th></tr></thead><tbody>{}</tbody></table></div></details>'
    ).format(len(undecided), restaged, len(undecided), rows)


def _tried(line: Mapping[str, Any] | None) -> Markup:
    """Describe the attempted fixes, grouped by the reason why they failed."""
    attempts = [one for one in (line or {}).get("tried") or () if isinstance(one, Mapping)]
    if not attempts:
        return Markup('<span class="none">what was tried is not on record</span>')
    by_why: dict[str, list[str]] = {}
    for one in attempts:
        by_why.setdefault(str(one.get("why", "")), []).append(str(one.get("how", "")))
    count = Counter({why: len(hows) for why, hows in by_why.items()})
    return Markup("").join(
        Markup("<div><strong><bdi>{}</bdi></strong> ({}): <bdi>{}</bdi></div>").format(
            why, tally, "; ".join(by_why[why])
        )
        for why, tally in count.most_common()
    )
