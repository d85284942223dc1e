"""Pictures of the metrics as inline SVG: distributions, diversity over the size, a map of the space.

They are the three panels of the paper's figure of metrics. Their data were computed when the study was measured
(`pictures` in `metrics.json`, see `oodscen.metrics._pictured`); colours come from the page's style sheet.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from markupsafe import Markup

from oodscen.report._charts import svg as charts
from oodscen.report._charts.drawing import WIDTH, px, svg
from oodscen.report._load import Material, dig, mapping, number
from oodscen.report._measures import scores, set_names
from oodscen.study import Study

_COLOURS = ("var(--accent)", "var(--unsafe)", "var(--safe)", "var(--warn)", "var(--amber)")
_GREY = "var(--off)"
_CURVE = 210
_MAP = 300


def part(study: Study, found: Material) -> Markup:
    """Draw all pictures that the study's measurements allow; empty if there are none.

    Args:
        study: Unused; all parts of the page share one signature.
        found: The material read from the study.
    """
    metrics = found.metrics
    names = set_names(metrics)
    pictures = (
        (
            _distributions(metrics, names),
            "OOD-ness of the study’s texts, of hand-written ordinary sentences in the style of scenarios, and of "
            "ordinary driving texts scored without their like. Where the first lie over the second, this measure "
            "does not tell them apart.",
        ),
        (_detected(metrics, names), _detector_caption(metrics, names)),
        (
            _curves(metrics, names),
            "Diversity of random subsets by their number of texts: to the nearest other text (solid) it "
            "falls as a set grows, over all pairs (dashed) it does not. Compare sets at equal size.",
        ),
        (_map(metrics, names), _map_caption(metrics)),
    )
    return Markup("").join(
        Markup('<figure class="chart-box">{}<figcaption>{}</figcaption></figure>').format(
            drawn, caption
        )
        for drawn, caption in pictures
        if drawn
    )


def _distributions(metrics: Mapping[str, Any], names: Sequence[str]) -> Markup:
    strips = [_strip(_short(name), scores(metrics, name)) for name in names]
    strips.append(_strip("ordinary", _numbers(dig(metrics, "pictures", "oodness", "control"))))
    strips.append(_strip("baseline", _numbers(dig(metrics, "pictures", "oodness", "held_out"))))
    known = [strip for strip in strips if strip is not None]
    return charts.histogram(known) if len(known) > 1 and strips[-1] else Markup("")


def _detected(metrics: Mapping[str, Any], names: Sequence[str]) -> Markup:
    detector = dig(metrics, "pictures", "detector")
    found = [(_short(name), _numbers(dig(detector, "sets", name, "per_text"))) for name in names]
    found.append(("ordinary", _numbers(dig(detector, "control"))))
    rows = [row for row in found if row[1]]
    return _boxes(rows) if len(rows) > 1 else Markup("")


def _detector_caption(metrics: Mapping[str, Any], names: Sequence[str]) -> str:
    detector = dig(metrics, "pictures", "detector")
    found = []
    for name in names:
        value, low, high = (
            number(detector, "sets", name, "auroc", key) for key in ("value", "low", "high")
        )
        if value is not None:
            bounds = "" if low is None or high is None else f" [{low:.2f}, {high:.2f}]"
            found.append(f"{_short(name)} {value:.2f}{bounds}")
    return (
        f"The detector “{dig(detector, 'name') or 'unknown'}” in standard deviations of ordinary driving; boxes hold "
        "the middle half, lines the middle nine tenths. Area under the ROC curve against the ordinary sentences "
        f"(0.5 tells nothing): {'; '.join(found)}."
    )


def _boxes(rows: Sequence[tuple[str, list[float]]]) -> Markup:
    left, right, step = 104, WIDTH - 14, 34
    ends = [_quantile(values, share) for _, values in rows for share in (0.0, 1.0)]
    low, high = math.floor(min(ends)), math.ceil(max(ends))
    high = max(high, low + 1)
    height = 12 + step * len(rows)
    every = max(1, math.ceil((high - low) / 8))

    def x(value: float) -> float:
        return left + (right - left) * (value - low) / (high - low)

    parts = [
        Markup(
            '<line class="grid" x1="{0}" x2="{0}" y1="6" y2="{1}"/><text class="tick middle" x="{0}" y="{2}">{3}</text>'
        ).format(px(x(value)), height, height + 16, charts.signed(value, 0))
        for value in range(low, high + 1, every)
    ]
    for place, (name, values) in enumerate(rows):
        middle = 12 + step * place + step / 2 - 6
        edges = [_quantile(values, share) for share in (0.05, 0.25, 0.5, 0.75, 0.95)]
        a, b, c, d, e = (px(x(edge)) for edge in edges)
        parts.append(
            Markup(
                '<text class="name" x="0" y="{y1}">{name}</text><text class="tick" x="0" y="{y2}">n = {n}</text>'
                '<line class="range" x1="{a}" x2="{e}" y1="{m}" y2="{m}"/>'
                '<rect class="bar" x="{b}" y="{top}" width="{w}" height="14"/>'
                '<path class="mean" d="M{c} {top}v14"/>'
            ).format(
                y1=px(middle),
                y2=px(middle + 13),
                name=name,
                n=len(values),
                a=a,
                e=e,
                m=px(middle),
                b=b,
                top=px(middle - 7),
                w=px(max(float(d) - float(b), 1.0)),
                c=c,
            )
        )
    return svg("Scores of the detector by set", height + 22, parts)


def _curves(metrics: Mapping[str, Any], names: Sequence[str]) -> Markup:
    curves = dig(metrics, "pictures", "curves")
    lines = []
    for place, name in enumerate(["baseline", *names]):
        sizes = _numbers(dig(curves, name, "sizes"))
        both = [_numbers(dig(curves, name, kind)) for kind in ("nearest", "pairwise")]
        if sizes and all(len(values) == len(sizes) for values in both):
            lines.append((name, _colour(place), sizes, both))
    if not lines:
        return Markup("")
    left, right, top = 40, WIDTH - 22, 10
    values = [value for *_, both in lines for values in both for value in values]
    low, high = math.floor(min(values) * 10) / 10, math.ceil(max(values) * 10) / 10
    high = max(high, low + 0.1)
    longest = max(max(sizes) for _, _, sizes, _ in lines)
    bottom = top + _CURVE

    def x(size: float) -> float:
        return left + (right - left) * math.log(max(size, 2) / 2) / max(math.log(longest / 2), 1e-9)

    def y(value: float) -> float:
        return bottom - (bottom - top) * (value - low) / (high - low)

    parts = []
    steps = round((high - low) * 10)
    for index in range(0, steps + 1, max(1, math.ceil(steps / 6))):
        value = low + index / 10
        parts.append(
            Markup(
                '<line class="grid" x1="{}" x2="{}" y1="{}" y2="{}"/><text class="tick end" x="{}" y="{}">{}</text>'
            ).format(
                left,
                right,
                px(y(value)),
                px(y(value)),
                left - 6,
                px(y(value) + 4),
                charts.signed(value, 1),
            )
        )
    parts += [
        Markup('<text class="tick middle" x="{}" y="{}">{}</text>').format(
            px(x(size)), bottom + 16, size
        )
        for size in (2, 10, 100, 1000)
        if size <= longest
    ]
    for _, colour, sizes, both in lines:
        for kind, values in enumerate(both):
            path = "L".join(
                f"{px(x(size))},{px(y(value))}" for size, value in zip(sizes, values, strict=True)
            )
            parts.append(
                Markup('<path d="M{}" fill="none" stroke="{}" stroke-width="2"{}/>').format(
                    path, colour, Markup(' stroke-dasharray="5 4"') if kind else ""
                )
            )
    entries = [(_short(name), colour) for name, colour, *_ in lines]
    parts += _legend(entries, bottom + 38)
    return svg("Diversity by number of texts", bottom + 28 + _legend_height(entries), parts)


def _map(metrics: Mapping[str, Any], names: Sequence[str]) -> Markup:
    points = mapping(dig(metrics, "pictures", "map", "points"))
    sets = []
    for place, name in enumerate(["baseline", *names]):
        found = points.get(name)
        pairs = [_numbers(pair) for pair in found] if isinstance(found, list) else []
        if pairs and all(len(pair) == 2 for pair in pairs):
            sets.append((name, _colour(place), pairs))
    if not sets:
        return Markup("")
    every = [pair for _, _, pairs in sets for pair in pairs]
    lows = [min(pair[axis] for pair in every) for axis in (0, 1)]
    highs = [max(pair[axis] for pair in every) for axis in (0, 1)]
    spans = [max(high - low, 1e-9) for low, high in zip(lows, highs, strict=True)]
    scale = min((WIDTH - 20) / spans[0], (_MAP - 20) / spans[1])
    height = 20 + spans[1] * scale
    parts = []
    for name, colour, pairs in sets:
        radius = 1.8 if name == "baseline" else 2.6
        dots = Markup("").join(
            Markup('<circle cx="{}" cy="{}" r="{}"/>').format(
                px(10 + (first - lows[0]) * scale),
                px(height - 10 - (second - lows[1]) * scale),
                radius,
            )
            for first, second in pairs
        )
        parts.append(
            Markup('<g fill="{}" fill-opacity="{}">{}</g>').format(
                colour, 0.45 if name == "baseline" else 0.7, dots
            )
        )
    entries = [(f"{_short(name)} ({len(pairs)})", colour) for name, colour, pairs in sets]
    parts += _legend(entries, height + 14)
    return svg("Texts on two principal axes", height + 4 + _legend_height(entries), parts)


def _map_caption(metrics: Mapping[str, Any]) -> str:
    share = _numbers(dig(metrics, "pictures", "map", "share"))
    held = f"{sum(share):.0%}" if share else "a part"
    return (
        "Texts on the two principal axes of the ordinary driving texts, at most 400 of each set. The axes hold "
        f"{held} of the variance: neighbours here may be far apart in the other dimensions."
    )


def _legend(entries: Sequence[tuple[str, str]], top: float) -> list[Markup]:
    return [
        Markup(
            '<circle cx="{}" cy="{}" r="5" fill="{}"/><text class="tick" x="{}" y="{}">{}</text>'
        ).format(
            px(10 + 155 * (place % 3)),
            px(top + 18 * (place // 3) - 4),
            colour,
            px(20 + 155 * (place % 3)),
            px(top + 18 * (place // 3)),
            label,
        )
        for place, (label, colour) in enumerate(entries)
    ]


def _legend_height(entries: Sequence[object]) -> float:
    return 18.0 * math.ceil(len(entries) / 3)


def _strip(label: str, values: list[float]) -> charts.Strip | None:
    return charts.Strip(label, values, sum(values) / len(values)) if values else None


def _short(name: str) -> str:
    return f"{name} texts" if name.isdigit() else name


def _colour(place: int) -> str:
    return _COLOURS[(place - 1) % len(_COLOURS)] if place else _GREY


def _numbers(found: object) -> list[float]:
    if not isinstance(found, list):
        return []
    values = [number(value) for value in found]
    return [value for value in values if value is not None] if None not in values else []


def _quantile(values: Sequence[float], share: float) -> float:
    order = sorted(values)
    place = share * (len(order) - 1)
    below = math.floor(place)
    above = min(below + 1, len(order) - 1)
    return order[below] + (order[above] - order[below]) * (place - below)
