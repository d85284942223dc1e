"""Scenes in plain words: weather, places, behaviours, triggers and outcomes."""

from collections import Counter
from collections.abc import Mapping
from types import MappingProxyType

from oodscen._words.decimals import seconds
from oodscen.data._designs.motion import Motion
from oodscen.data._details import Details
from oodscen.data._episode import ActionOutcome
from oodscen.data._map_state import MapState
from oodscen.data._scene import Actor, Behaviour, Placement, Trigger
from oodscen.data._weather import CLEAR_AIR_M, DUSK_DEG, FOG_M, Weather
from oodscen.driving._motion.behaviours.table import BUILT_IN, USUAL

_STATES = {
    "brake": "brake lights",
    "hazard": "hazard lights",
    "beacon": "beacon on",
    "indicate_left": "indicating left",
    "indicate_right": "indicating right",
}

_UNITS = {
    "speed": "m/s",
    "deceleration": "m/s²",
    "duration": "s",
    "period": "s",
    "pause": "s",
    "distance": "m",
    "amplitude": "m",
    "lateral": "m to the left",
    "lanes": "lanes to the left",
}


def plain_words(identifier: str) -> str:
    """Return an id as words."""
    return identifier.replace("_", " ").replace("-", " ").strip() or identifier


def amount(value: float) -> str:
    """Return a quantity as text: three digits or all whole ones, four decimals at most, a true minus sign."""
    text = f"{round(value, 4):z.3g}" if abs(value) < 999.5 else f"{value:.0f}"
    return text.replace("-", "\N{MINUS SIGN}")


def p_value(value: float) -> str:
    """Return a p-value as text."""
    return "< 0.001" if value < 0.001 else f"{value:.3f}"


def duration(value: float) -> str:
    """Return a time span as text."""
    if value < 10:
        return seconds(value)
    whole = round(value)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60} s"
    return f"{whole // 3600} h {whole % 3600 // 60} min"


def weather(value: Weather) -> str:
    """Describe weather and light in one phrase."""
    parts = [_light(value.sun_elevation_deg)]
    if value.fog_visual_range_m < CLEAR_AIR_M:
        haze = _haze(value.fog_visual_range_m)
        parts.append(f"{haze}, sight {amount(value.fog_visual_range_m)} m")
    if value.precipitation != "none":
        degree = _intensity(value.precipitation_mm_h)
        parts.append(f"{degree} {value.precipitation}, {amount(value.precipitation_mm_h)} mm/h")
    elif value.fog_visual_range_m >= CLEAR_AIR_M and value.sun_elevation_deg > DUSK_DEG:
        parts.append("overcast" if value.cloud_cover > 0.7 else "dry")
    if value.friction < 0.95:
        parts.append(f"{_surface(value.friction)} road, friction {amount(value.friction)}")
    return "; ".join(parts)


def _haze(visual_range_m: float) -> str:
    if visual_range_m >= FOG_M:
        return "haze"
    return "thick fog" if visual_range_m < 150 else "fog"


def _intensity(rate_mm_h: float) -> str:
    if rate_mm_h < 2.5:
        return "light"
    return "moderate" if rate_mm_h < 10 else "heavy"


def _surface(friction: float) -> str:
    if friction <= 0.2:
        return "icy"
    return "slippery" if friction <= 0.5 else "wet"


def place(value: Placement) -> str:
    """Describe the start position of an actor, as seen from the ego."""
    distance = (
        f"{amount(value.ahead_m)} m ahead"
        if value.ahead_m >= 0
        else f"{amount(-value.ahead_m)} m behind"
    )
    parts = [distance, *_across(value)]
    turned = abs(value.heading_deg)
    if turned > 150:
        parts.append("facing against its lane")
    elif turned > 20:
        side = "left" if value.heading_deg > 0 else "right"
        parts.append(f"turned {amount(turned)}° to the {side}")
    return ", ".join(parts)


def _across(value: Placement) -> list[str]:
    """Describe the place across the road; what lies further off than half a lane is in none by these words."""
    lane, within = "the ego’s lane", "in the ego’s lane"
    if value.lane:
        count = "one lane" if abs(value.lane) == 1 else f"{abs(value.lane)} lanes"
        within = f"{count} to the {'left' if value.lane > 0 else 'right'}"
        lane = f"the lane {within}"
    off = f"{amount(abs(value.offset_m))} m {'left' if value.offset_m > 0 else 'right'} of"
    if abs(value.offset_m) > _HALF_A_LANE_M:
        return [f"{off} the centre of {lane}"]
    return [within, f"{off} its centre"] if abs(value.offset_m) >= _CENTRED_M else [within]


_HALF_A_LANE_M = 1.5
"""Half the width of a narrow lane, m."""
_CENTRED_M = 0.3
"""Distance from the centre of a lane that is not worth a word, m."""


def behaviour(value: Behaviour, motions: Mapping[str, Motion] = MappingProxyType({})) -> str:
    """Describe an actor's behaviour, with its parameters and its start.

    Args:
        value: The behaviour.
        motions: Motions made to order, by id.
    """
    built_in, motion = BUILT_IN.get(value.name), motions.get(value.name)
    text = (built_in.phrase if built_in else "") or plain_words(value.name)
    if motion is not None:
        text = f"{motion.description} (made to order)"
    parameters = [
        f"{plain_words(name)} {amount(number)} {_UNITS.get(name, '')}".strip()
        for name, number in sorted(value.parameters.items())
    ]
    if parameters:
        text += f" ({', '.join(parameters)})"
    if value.name in USUAL:
        return text
    return f"{text}, {trigger(value.trigger, 'the ego', 'it')}"


def trigger(value: Trigger, ego: str, target: str) -> str:
    """Describe the condition under which something starts.

    Args:
        value: The trigger.
        ego: Name of the ego.
        target: Name of the actor that the trigger measures to, if the trigger names none.
    """
    other = value.actor or target
    if value.kind == "time":
        return "from the start" if value.value == 0 else f"after {amount(value.value)} s"
    if value.kind == "distance":
        return f"once {ego} is within {amount(value.value)} m of {other}"
    return f"once {ego} is {amount(value.value)} s from hitting {other}"


def actor_name(actor: Actor) -> str:
    """Return an actor's name: its asset, with its state and its details if it has any."""
    remarks = []
    if actor.state not in ("", "off"):
        remarks.append(_STATES.get(actor.state, plain_words(actor.state)))
    if actor.details is not None:
        remarks += details(actor.details)
    name = plain_words(actor.asset)
    return f"{name} ({', '.join(remarks)})" if remarks else name


def details(value: Details) -> list[str]:
    """Return the details of an actor in words, one by one."""
    phrases = [
        plain_words(value.pose) if value.pose else "",
        f"holding a {plain_words(value.holds)}" if value.holds else "",
        *map(plain_words, value.parts),
        f"painted {value.colour.replace('_', ' ')}" if value.colour else "",
        f"carrying a {plain_words(value.cargo)}" if value.cargo else "",
        f"“{value.text}” on its sides" if value.text else "",
    ]
    return [phrase for phrase in phrases if phrase]


def map_faults(value: MapState) -> list[str]:
    """Return what is out of order on a map in words."""
    return [f"{plain_words(part)}: {plain_words(state)}" for part, state in value.faults()]


def outcome(value: ActionOutcome, names: Mapping[str, str]) -> str:
    """Describe the outcome of an action in a few words.

    Args:
        value: The outcome.
        names: Names of the actors, by id.
    """
    if value.unavailable:
        return "no such lane"
    if value.marginal:
        return "depends on the driver"
    if value.contacts:
        counts = Counter(names.get(item, plain_words(item)) for item in value.contacts)
        touched = [f"{name} ×{count}" if count > 1 else name for name, count in counts.items()]
        return f"hits {', '.join(touched)}"
    if value.off_road:
        return "leaves the road"
    if value.ran_red:
        return "drives past the red light"
    if value.margin_m is None:
        return "nothing near"
    return f"gap {value.margin_m:.1f} m"


def measures(value: ActionOutcome) -> str:
    """Return the time to collision, deceleration and jerk of an action as text."""
    if value.unavailable:
        return ""
    parts = []
    if value.min_ttc_s is not None and value.min_ttc_s > 0:
        parts.append(f"TTC {seconds(value.min_ttc_s)}")
    if value.peak_deceleration is not None:
        parts.append(f"brakes {value.peak_deceleration:.1f} m/s²")
    if value.peak_jerk is not None:
        parts.append(f"jerk {value.peak_jerk:.0f} m/s³")
    return ", ".join(parts)


def _light(sun_elevation_deg: float) -> str:
    if sun_elevation_deg <= DUSK_DEG:
        return "night"
    if sun_elevation_deg < 3:
        return "twilight"
    return "low sun" if sun_elevation_deg < 12 else "day"
