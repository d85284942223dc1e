"""The saturation chart: the new kinds that each round found, and the estimate of those left."""

from markupsafe import Markup

from oodscen.report._charts.drawing import WIDTH, px, svg
from oodscen.report._charts.svg import scale
from oodscen.stages._redteam.saturation import Saturation

_LEFT, _RIGHT, _TOP, _BOTTOM = 34, WIDTH - 58, 14, 160


def saturation_chart(found: Saturation) -> Markup:
    """Draw new kinds and Good-Turing coverage over the rounds.

    The line counts the new kinds. The dot and bar at its end are the estimated total and its interval, as
    far as they lie inside the chart. The dotted line is the coverage, on the right axis.

    Args:
        found: The estimates; without rounds the chart is empty.

    Returns:
        Inline SVG, coloured by the page's style sheet.
    """
    if not found.curve:
        return Markup("")
    last = max(found.curve[-1].round, 1)
    total = found.kinds + found.unseen
    _, high, step = scale(0, max(round(min(1.1 * total, 1.6 * found.kinds)), 4), 4)

    def x(value: float) -> float:
        return _LEFT + (_RIGHT - _LEFT) * value / last

    def y(value: float) -> float:
        return _BOTTOM - (_BOTTOM - _TOP) * min(value / high, 1.0)

    parts = [
        Markup(
            '<line class="grid" x1="{}" x2="{}" y1="{}" y2="{}"/><text class="tick end" x="{}" y="{}">{}</text>'
        ).format(_LEFT, _RIGHT, px(y(value)), px(y(value)), _LEFT - 6, px(y(value) + 4), value)
        for value in range(0, high + 1, step)
    ]
    parts += [
        Markup('<text class="tick" x="{}" y="{}">{}</text>').format(
            _RIGHT + 12, px(_BOTTOM - (_BOTTOM - _TOP) * share / 100 + 4), f"{share} %"
        )
        for share in (0, 50, 100)
    ]
    coverage = "".join(
        f"{'L' if place else 'M'}{px(x(point.round))},{px(y(high * point.coverage))}"
        for place, point in enumerate(found.curve)
    )
    kinds = f"M{px(x(0))},{px(y(0))}"
    for point in found.curve:
        kinds += f"H{px(x(point.round))}V{px(y(point.kinds))}"
    parts.append(Markup('<path class="reference" fill="none" d="{}"/>').format(coverage))
    parts.append(Markup('<path class="line" d="{}"/>').format(kinds))
    if found.unseen_high > 0.0 and found.kinds + found.unseen_low < high:
        parts.append(
            Markup('<line class="range" x1="{0}" x2="{0}" y1="{1}" y2="{2}"/>').format(
                px(_RIGHT + 5),
                px(y(found.kinds + found.unseen_low)),
                px(y(found.kinds + found.unseen_high)),
            )
        )
    if found.unseen > 0.0 and total <= high:
        parts.append(
            Markup('<circle class="dot" cx="{}" cy="{}" r="3.5"/>').format(
                px(_RIGHT + 5), px(y(total))
            )
        )
    if found.dry_from is not None:
        parts.append(
            Markup(
                '<line class="grid" x1="{0}" x2="{0}" y1="{1}" y2="{2}"/><text class="tick end" x="{3}" y="{4}">{5}</text>'
            ).format(
                px(x(found.dry_from)),
                _TOP,
                _BOTTOM,
                px(x(found.dry_from) - 4),
                _BOTTOM - 6,
                f"dry from {found.dry_from}",
            )
        )
    parts += [
        Markup('<text class="tick middle" x="{}" y="{}">{}</text>').format(
            px(x(value)), _BOTTOM + 16, value
        )
        for value in sorted({0, last // 2, last})
    ]
    parts.append(
        Markup('<text class="tick end" x="{}" y="{}">rounds</text>').format(_RIGHT, _BOTTOM + 30)
    )
    parts.append(
        Markup(
            '<text class="tick" x="0" y="{}">new kinds (line), Good-Turing coverage (dotted)</text>'
        ).format(_BOTTOM + 30)
    )
    label = (
        f"New kinds over {last} rounds of red teaming: {found.kinds}; about {found.unseen:.0f} unseen, "
        f"coverage {found.coverage:.0%}"
    )
    return svg(label, _BOTTOM + 34, parts)
