"""OpenDRIVE texts that the driving tests share."""

from oodscen.driving import read_network
from oodscen.driving._roads.network import Road

LANE = (
    '<lane id="{id}" type="{type}"><link>{link}</link>'
    '<width sOffset="0" a="{width}" b="0" c="0" d="0"/></lane>'
)


def lane(id: int, type: str = "driving", width: float = 3.5, link: str = "") -> str:
    return LANE.format(id=id, type=type, width=width, link=link)


def road(
    id: str,
    length: float,
    *,
    at: tuple[float, float, float] = (0.0, 0.0, 0.0),
    right: str = "",
    left: str = "",
    link: str = "",
    junction: str = "-1",
    shape: str = "<line/>",
    offset: float = 0.0,
    more: str = "",
) -> str:
    x, y, heading = at
    return (
        f'<road id="{id}" length="{length}" junction="{junction}"><link>{link}</link><planView>'
        f'<geometry s="0" x="{x}" y="{y}" hdg="{heading}" length="{length}">{shape}</geometry>'
        f'</planView><lanes><laneOffset s="0" a="{offset}" b="0" c="0" d="0"/>'
        f'<laneSection s="0"><left>{left}</left><center><lane id="0" type="none"/></center>'
        f"<right>{right}</right></laneSection></lanes>{more}</road>"
    )


def read_road(data: bytes) -> Road:
    """Return the first road of a file."""
    return next(iter(read_network(data).roads.values()))


def file(*parts: str) -> bytes:
    return f"<OpenDRIVE>{''.join(parts)}</OpenDRIVE>".encode()


def single_lane_junction(beside: float) -> bytes:
    """Return a road, a junction with one lane per connecting road, and the road after it.

    The connecting roads' reference lines lie `beside` metres left of their lane's left edge.
    """
    to, back = '<{} elementType="junction" elementId="J"/>', '<{} elementType="road" {}/>'
    both = lane(-1) + lane(-2)
    other = lane(1) + lane(2)
    before = road("1", 100.0, right=both, left=other, link=to.format("successor"))
    after = road(
        "2", 300.0, at=(120.0, 0.0, 0.0), right=both, left=other, link=to.format("predecessor")
    )
    ends = back.format("predecessor", 'elementId="1" contactPoint="end"') + back.format(
        "successor", 'elementId="2" contactPoint="start"'
    )
    through = [
        road(
            f"1{number}",
            20.0,
            at=(100.0, beside - 3.5 * (number - 1), 0.0),
            right=lane(-1, link=f'<predecessor id="-{number}"/><successor id="-{number}"/>'),
            link=ends,
            junction="J",
            offset=-beside,
        )
        for number in (1, 2)
    ]
    connections = "".join(
        f'<connection id="{n}" incomingRoad="1" connectingRoad="1{n}" contactPoint="start">'
        f'<laneLink from="-{n}" to="-1"/></connection>'
        for n in (1, 2)
    )
    return file(before, after, *through, f'<junction id="J">{connections}</junction>')
