"""Demands at the kerb: buses at their stops, refuse lorries at work, proper road works."""

import numpy as np

from oodscen.data._scene import Actor
from oodscen.stages._demands.setting import Draft, Setting, actor, demand

_CALM = 3.6
"""Deceleration that a standing vehicle may ask of the ego, m/s^2."""
_ASIDE_M = (0.1, 0.4)
"""Offset of a standing vehicle towards the kerb, if there is room, m."""


def _at_kerb(setting: Setting, asset: str, rng: np.random.Generator) -> tuple[float, float]:
    """Return how far ahead a vehicle stands at the kerb, and its offset, m."""
    ahead_m = setting.decision_m + setting.gap_to(0.5 * setting.length(asset), 2.0, _CALM)
    room_m = setting.edge(ahead_m) - 0.5 * setting.assets[asset].width - 0.2
    return ahead_m, -min(room_m, float(rng.uniform(*_ASIDE_M)))


def _is_street(setting: Setting) -> bool:
    """Return whether the road is a plain street with a pavement beside the ego's lane."""
    return (
        setting.has("urban", "residential")
        and not setting.lane
        and not setting.has("junction", "roundabout")
    )


def bus_stop(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a bus at its stop, its indicator on, and people who get on."""
    if "bus" not in setting.assets or not _is_street(setting):
        return None
    ahead_m, offset_m = _at_kerb(setting, "bus", rng)
    actors = [actor("bus", "bus", ahead_m, offset_m=offset_m, state="indicate_right")]
    kerb_m = setting.edge(ahead_m)
    if "bus_stop" in setting.assets:
        actors.append(
            actor("stop", "bus_stop", ahead_m + 1.0, offset_m=-kerb_m - 2.1, heading_deg=180.0)
        )
    for number in range(1, int(rng.integers(2, 5))):
        asset = setting.choose(rng, "adult", "elderly_person", "child")
        if asset:
            along_m = ahead_m + 3.2 - 1.7 * number + float(rng.uniform(-0.2, 0.2))
            outside_m = kerb_m + 0.5 + float(rng.uniform(0.0, 0.3))
            heading_deg = float(rng.uniform(50.0, 120.0))
            actors.append(
                actor(
                    f"passenger-{number}",
                    asset,
                    along_m,
                    offset_m=-outside_m,
                    heading_deg=heading_deg,
                )
            )
    quote = "a bus stands at its stop with its indicator on"
    return demand(actors, "bus", quote, ("motion", "stationary"), rest=" ahead in the lane")


def refuse_lorry(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a refuse lorry that empties bins, its beacon on."""
    if not {"garbage_truck", "worker", "wheelie_bin"} <= setting.assets.keys():
        return None
    if not _is_street(setting):
        return None
    ahead_m, offset_m = _at_kerb(setting, "garbage_truck", rng)
    reach = 0.5 * setting.length("garbage_truck")
    kerb_m = setting.edge(ahead_m)
    actors = [actor("refuse-lorry", "garbage_truck", ahead_m, offset_m=offset_m, state="beacon")]
    actors.append(
        actor("loader", "worker", ahead_m - reach - 0.8, offset_m=offset_m - 0.7, heading_deg=90.0)
    )
    for number in range(1, int(rng.integers(3, 6))):
        along_m = ahead_m - 9.0 + 4.6 * number + float(rng.uniform(-0.6, 0.6))
        heading_deg = float(rng.uniform(-12.0, 12.0))
        actors.append(
            actor(
                f"bin-{number}",
                "wheelie_bin",
                along_m,
                offset_m=-kerb_m - 0.6,
                heading_deg=heading_deg,
            )
        )
    quote = "a refuse lorry with its beacon on stands ahead and collects bins from the pavement"
    return demand(actors, "refuse lorry", quote, ("motion", "stationary"), ("state", "beacon"))


def works(setting: Setting, rng: np.random.Generator) -> Draft | None:
    """Return a proper lane closure: sign, taper, arrow board or shuttle light, machine and worker."""
    if not {"cone", "road_works_sign", "worker"} <= setting.assets.keys():
        return None
    if setting.has("tunnel", "roundabout", "junction", "bridge"):
        return None
    begin = setting.decision_m + setting.gap_to(0.0, 1.0, _CALM)
    half = setting.half_width(begin)
    close = _close_only_lane if setting.lanes == 1 else _close_lane
    actors = close(setting, rng, begin, half)
    if not actors:
        return None
    quote = "road works with a sign and a row of cones close the lane ahead"
    return demand(actors, "cone", quote, ("motion", "stationary"), ("place", "ahead"))


def _close_only_lane(
    setting: Setting, rng: np.random.Generator, begin: float, half: float
) -> list[Actor]:
    """Close the only lane, with a light for alternate traffic."""
    if not {"barrier", "temporary_light"} <= setting.assets.keys():
        return []
    machine = setting.choose(rng, "excavator", "road_roller", "generator")
    side = setting.edge(begin)
    actors = [actor("sign", "road_works_sign", max(begin - 26.0, 8.0), offset_m=-side - 0.6)]
    for number in range(4):
        across = -half + 0.3 + (2.0 * half - 0.75) * number / 3.0
        actors.append(actor(f"cone-{number + 1}", "cone", begin + 2.6 * number, offset_m=across))
    end = begin + 10.9
    actors.append(actor("barrier", "barrier", end, offset_m=-0.1))
    actors.append(actor("worker", "worker", end + 2.2, offset_m=float(rng.uniform(-0.8, 0.6))))
    if machine:
        actors.append(actor("machine", machine, end + 7.5, offset_m=-0.2))
    actors.append(actor("light", "temporary_light", begin - 1.5, offset_m=-side - 0.5, state="red"))
    return actors


def _close_lane(
    setting: Setting, rng: np.random.Generator, begin: float, half: float
) -> list[Actor]:
    """Close the ego's lane where another lane leads the same way."""
    if "arrow_board" not in setting.assets or setting.lane not in (0, setting.lanes - 1):
        return []
    machine = setting.choose(rng, "excavator", "truck", "road_roller")
    towards = 1.0 if setting.lane == 0 else -1.0
    is_fast = setting.has("highway")
    count, gap = (8, 5.0) if is_fast else (6, 3.0)
    side = setting.edge(begin, -1 if setting.lane == 0 else 1)
    actors = []
    if setting.lane == 0 or is_fast:
        near = max(begin - 24.0, 8.0)
        actors.append(actor("sign", "road_works_sign", near, offset_m=-towards * (side + 0.6)))
    for number in range(count):
        across = -towards * (half - 0.3) + towards * (2.0 * half - 0.5) * number / (count - 1)
        actors.append(actor(f"cone-{number + 1}", "cone", begin + gap * number, offset_m=across))
    board = begin + gap * (count - 1) + 3.0
    state = "left" if towards > 0.0 else "right"
    actors.append(actor("board", "arrow_board", board, state=state))
    for number in range(3):
        along = board + 4.0 * number + 1.0
        actors.append(actor(f"edge-{number + 1}", "cone", along, offset_m=towards * (half - 0.15)))
    actors.append(actor("worker", "worker", board + 5.0, offset_m=-0.4 * towards, heading_deg=90.0))
    if machine:
        actors.append(actor("machine", machine, board + 12.0, offset_m=-0.2 * towards))
    return actors
