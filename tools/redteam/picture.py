"""Draws the saturation of several red teams in one picture: new kinds, and Good-Turing coverage, by round.

Run as `python -m tools.redteam.picture OUT.svg NAME=redteam.jsonl [NAME=redteam.jsonl ...]`; each file is the log
of a study or of `oodscen redteam --log`.
"""

import sys
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from oodscen.stages._redteam.rounds import Round
from oodscen.stages._redteam.saturation import Saturation, saturation

WIDTH, HEIGHT = 720, 300
_LEFT, _RIGHT, _TOP, _BOTTOM = 46, WIDTH - 190, 22, HEIGHT - 40
_COLOURS = ("#2b6cb0", "#c05621", "#2f855a", "#6b46c1")


def picture(found: Mapping[str, Saturation]) -> str:
    """Return an SVG picture: solid lines count new kinds, dotted ones are the coverage.

    Args:
        found: The saturation of each red team by name, at most one per colour.
    """
    last = max(one.curve[-1].round for one in found.values())
    most = max(max(one.kinds for one in found.values()), 1)

    def x(value: float) -> float:
        return round(_LEFT + (_RIGHT - _LEFT) * value / last, 1)

    def y(share: float) -> float:
        return round(_BOTTOM - (_BOTTOM - _TOP) * share, 1)

    parts = [
        f'<path d="M{_LEFT},{y(share)}H{_RIGHT}" stroke="#ccc"/>'
        f'<text x="{_LEFT - 8}" y="{y(share) + 4}" text-anchor="end">{most * share:.0f}</text>'
        f'<text x="{_RIGHT + 8}" y="{y(share) + 4}">{share:.0%}</text>'
        for share in (0.0, 0.25, 0.5, 0.75, 1.0)
    ]
    for place, (name, one) in enumerate(found.items()):
        colour = _COLOURS[place]
        kinds = f"M{x(0)},{y(0)}" + "".join(
            f"H{x(point.round)}V{y(point.kinds / most)}" for point in one.curve
        )
        coverage = "M" + "L".join(f"{x(point.round)},{y(point.coverage)}" for point in one.curve)
        top = _TOP + 44 * place
        parts.append(
            f'<path d="{kinds}" stroke="{colour}" stroke-width="2" fill="none"/>'
            f'<path d="{coverage}" stroke="{colour}" stroke-dasharray="2 3" fill="none"/>'
            f'<text x="{_RIGHT + 56}" y="{top + 4}" fill="{colour}">{escape(name)}</text>'
            f'<text x="{_RIGHT + 56}" y="{top + 20}">{one.kinds} kinds, {one.rounds} rounds</text>'
        )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" '
        'font-size="12" fill="#444">'
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#fff"/>'
        + "".join(parts)
        + f'<text x="{_LEFT}" y="{_TOP - 9}">new kinds (solid)</text>'
        f'<text x="{_RIGHT + 34}" y="{_TOP - 9}" text-anchor="end">coverage (dotted)</text>'
        f'<text x="{(_LEFT + _RIGHT) / 2}" y="{HEIGHT - 8}" text-anchor="middle">round, to {last}</text></svg>\n'
    )


def main(arguments: Sequence[str]) -> None:
    """Read the logs and write the picture."""
    out, *named = arguments
    logs = dict(one.split("=", 1) for one in named)
    found = {
        name: saturation(map(Round.parse, Path(log).read_text("utf-8").splitlines()))
        for name, log in logs.items()
    }
    Path(out).write_text(picture(found), "utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
