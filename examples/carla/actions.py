"""Tries seven actions in a scene of a study with CARLA's official client, as any script for CARLA would.

    oodscen serve --carla 2000 OUT &
    python examples/carla/actions.py SCENE_ID --decision 6.35 --horizon 8

Up to the decision (`decision_s` of the scene's episode) the hero drives by itself. From there each action is
driven with throttle, brake and steering by three drivers, who react after 0.2, 0.5 and 0.8 s; the collision
sensor and the map tell what comes of it. `--friction 0.9 1 --speed 0.95 1 1.05` also varies the road's friction
and the hero's speed at the decision. Nothing but the `carla` package is used.
"""

import argparse
import json
import math
import sys
from collections.abc import Iterator
from itertools import product
from typing import Any, NamedTuple

import carla

ACTIONS = (
    *("keep_speed", "slow_down", "stop", "emergency_brake"),
    *("change_lane_left", "change_lane_right", "pull_over"),
)
DT, GRAVITY = 0.05, 9.81
MOTOR, TOP_SPEED, BRAKE, LOCK = 4.0, 55.0, 8.0, 0.6
"""The hero's pedals and wheel: m/s^2 at full throttle from a standstill, the speed at which that is nothing,
m/s, m/s^2 of the full brake, and rad of the front wheels at full lock."""
SLACK = 0.02
"""Distance beyond the edge of a lane that is still on it, m."""
ROAD = (carla.LaneType.Driving, carla.LaneType.Shoulder, carla.LaneType.Parking)


class Place(NamedTuple):
    """The hero on its lane; offsets are to the left of the lane's centre, as are turns."""

    speed: float
    offset: float
    askew: float
    """Heading relative to the lane, rad."""
    waypoint: Any
    bends: tuple[float, ...]
    """Curvature of the lane, 1/m: 0.2 s ahead, and at ten places within the way to stop."""


class Plan(NamedTuple):
    """An action: a speed to hold, or a deceleration to a standstill, and a move to the left."""

    goal: float
    deceleration: float
    origin: float = 0.0
    shift: float = 0.0
    distance: float = 1.0


class Driver(NamedTuple):
    """What differs from drive to drive: the reaction time, s, and shares of friction and speed."""

    reaction: float
    friction: float = 1.0
    speed: float = 1.0


class Lane:
    """The centre line of the hero's lane and what follows it, straight on."""

    def __init__(self, world_map: Any, start: Any) -> None:
        self.map = world_map
        first = world_map.get_waypoint(start.location)
        self.ways = [first]
        back = first.previous(4.0)
        if back:
            self.ways.insert(0, min(back, key=lambda one: _turn(one, first)))
        for _ in range(700):
            ahead = self.ways[-1].next(1.0)
            if not ahead:
                break
            self.ways.append(min(ahead, key=lambda one: _turn(self.ways[-1], one)))
        self.lines = [_line(way) for way in self.ways]
        self.at = 0
        self._edges: dict[int, tuple[float, float]] = {}

    def place(self, hero: Any, pace: float = 1.0) -> Place:
        """Return where the hero is on the lane, at `pace` times the speed that the server last told."""
        here, velocity = hero.get_transform(), hero.get_velocity()
        x, y = here.location.x, -here.location.y
        while self.at + 2 < len(self.lines) and self._share(self.at, x, y) > 1.0:
            self.at += 1
        (ax, ay, a), (bx, by, b) = self.lines[self.at], self.lines[self.at + 1]
        share = self._share(self.at, x, y)
        course = a + max(0.0, min(1.0, share)) * _wrapped(b - a)
        mx, my = ax + share * (bx - ax), ay + share * (by - ay)
        # Between two points the centre bulges: its distance from their chord.
        chord = math.hypot(bx - ax, by - ay)
        bulge = -0.5 * _wrapped(b - a) * chord * share * (1.0 - share)
        offset = (y - my) * math.cos(course) - (x - mx) * math.sin(course) - bulge
        speed = pace * math.hypot(velocity.x, velocity.y)
        away = (max(1.0, 0.2 * speed), *looked_at(speed))
        bends = tuple(self._bend(share + one) for one in away)
        askew = _wrapped(-math.radians(here.rotation.yaw) - course)
        waypoint = self.map.get_waypoint(here.location)
        return Place(speed, offset, askew, waypoint, bends)

    def locate(self, location: Any) -> tuple[int, float]:
        """Return the nearest point of the centre line, and the offset from it, m."""
        x, y = location.x, -location.y
        near = range(max(0, self.at - 8), min(len(self.lines), self.at + 12))
        index = min(near, key=lambda k: math.dist(self.lines[k][:2], (x, y)))
        px, py, yaw = self.lines[index]
        return index, (y - py) * math.cos(yaw) - (x - px) * math.sin(yaw)

    def edges(self, index: int) -> tuple[float, float]:
        """Return the offsets of the road's right and left edge, m."""
        if index not in self._edges:
            way = self.ways[index]
            right, left = [way], [way]
            while (other := right[-1].get_right_lane()) is not None and other.lane_type in ROAD:
                right.append(other)
            while (other := _leftwards(left[-1], way)) is not None and other.lane_type in ROAD:
                left.append(other)
            self._edges[index] = (
                offset_of(way, right[-1]) - 0.5 * right[-1].lane_width,
                offset_of(way, left[-1]) + 0.5 * left[-1].lane_width,
            )
        return self._edges[index]

    def _share(self, index: int, x: float, y: float) -> float:
        (ax, ay, _), (bx, by, _) = self.lines[index], self.lines[index + 1]
        long = (bx - ax) ** 2 + (by - ay) ** 2
        return ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / max(long, 1e-9)

    def _bend(self, ahead: float) -> float:
        index = min(max(self.at + math.floor(ahead + 0.5), 1), len(self.lines) - 2)
        (ax, ay, a), (bx, by, b) = self.lines[index - 1], self.lines[index + 1]
        return _wrapped(b - a) / max(math.hypot(bx - ax, by - ay), 1e-6)


def target_lane(action: str, place: Place) -> Any:
    """Return the lane to which a change goes, or nothing if it does not exist."""
    way = place.waypoint
    other = way.get_left_lane() if action == "change_lane_left" else way.get_right_lane()
    return other if other is not None and other.lane_type == carla.LaneType.Driving else None


def plan_of(action: str, place: Place, mu: float, half_width: float) -> Plan:
    """Return the plan of an action."""
    speed = place.speed
    if action in ("keep_speed", "slow_down"):
        return Plan(speed if action == "keep_speed" else 0.5 * speed, 0.0)
    if action in ("stop", "emergency_brake"):
        return Plan(-1.0, 3.5 if action == "stop" else 8.0)
    if action == "pull_over":
        shift = roadside_of(place, half_width) - place.offset
        least = max(_stretch(speed, shift, mu, 2.0, 0.45), (2800.0 * abs(shift)) ** (1 / 3))
        room = max(1.15 * least, 0.5 * speed * speed / min(2.5, 0.5 * mu * GRAVITY), 1.0)
        return Plan(-1.0, max(0.5 * speed * speed / room, 0.3), place.offset, shift, least)
    other = target_lane(action, place)
    shift = 0.0 if other is None else offset_of(place.waypoint, other) - place.offset
    return Plan(speed, 0.0, place.offset, shift, _stretch(speed, shift, mu, 3.0, 0.5))


def offset_of(waypoint: Any, other: Any) -> float:
    """Return the distance of another lane's centre to the left, m."""
    yaw = -math.radians(waypoint.transform.rotation.yaw)
    one, two = waypoint.transform.location, other.transform.location
    return -(two.y - one.y) * math.cos(yaw) - (two.x - one.x) * math.sin(yaw)


def roadside_of(place: Place, half_width: float) -> float:
    """Return the offset at which the hero is clear of the lanes, m."""
    outer = here = place.waypoint
    edge = verge = offset_of(here, outer) - 0.5 * outer.lane_width
    while (outer := outer.get_right_lane()) is not None and outer.lane_type in ROAD:
        verge = offset_of(here, outer) - 0.5 * outer.lane_width
        if outer.lane_type == carla.LaneType.Driving:
            edge = verge
    return max(edge - half_width - 0.2, verge + half_width + 0.25)


def follow(plan: Plan, travelled: float, place: Place, mu: float, base: float) -> Any:
    """Return the pedals and the wheel of the next tick."""
    p = max(0.0, min(1.0, travelled / plan.distance))
    rest = 1.0 - p
    offset = plan.origin + plan.shift * p**3 * (10.0 + p * (6.0 * p - 15.0))
    slope = plan.shift / plan.distance * 30.0 * p * p * rest * rest
    turn = plan.shift / plan.distance**2 * 60.0 * p * rest * (1.0 - 2.0 * p)
    speed, bend = place.speed, place.bends[0]
    bend /= max(0.2, 1.0 - bend * place.offset)
    reach = max(3.0, min(0.8 * speed, 0.3 / max(abs(bend), 1e-3)))
    ahead = bend + turn / math.sqrt(1.0 - slope * slope)
    askew = place.askew + _slip(base, ahead) - math.asin(slope)
    wanted = ahead - (place.offset - offset) / reach**2 - 2.0 * math.sin(askew) / reach
    square = max(speed * speed, 0.01)
    most = 0.92 * mu * GRAVITY / square
    wanted = max(-most, min(most, wanted))
    steering = max(-LOCK, min(LOCK, math.atan(2.0 * math.tan(_slip(base, wanted)))))
    left = math.sqrt(max(0.0, (0.97 * mu * GRAVITY) ** 2 - (square * wanted) ** 2))
    push = -plan.deceleration
    if plan.goal >= 0.0:
        push = max(-2.0, min(2.0, 1.5 * (plan.goal - speed)))
    push = min(push, 3.0 * (curve_speed(place) - speed))
    return pedals(max(-left, min(left, push)), speed, steering)


def curve_speed(place: Place) -> float:
    """Return the speed that the bends ahead allow, m/s."""
    square = 1e6
    for bend, away in zip(place.bends[1:], looked_at(place.speed), strict=True):
        if abs(bend) > 1e-5:
            along = 0.6 * GRAVITY / abs(bend / max(0.2, 1.0 - bend * place.offset))
            square = min(square, along + 2.0 * 2.5 * max(0.0, away - 5.0))
    return math.sqrt(square)


def looked_at(speed: float) -> list[float]:
    """Return the ten distances at which bends ahead are looked for, m."""
    reach = 0.5 * speed * speed / 2.5 + 10.0
    return [reach * k / 9.0 for k in range(10)]


def pedals(push: float, speed: float, steering: float) -> Any:
    """Return the control for an acceleration, m/s^2, and an angle of the front wheels to the left, rad."""
    force = push + 0.1 + 0.0006 * speed * speed
    motor = MOTOR * max(1e-3, 1.0 - speed / TOP_SPEED)
    throttle, brake = max(0.0, min(1.0, force / motor)), max(0.0, min(1.0, -force / BRAKE))
    return carla.VehicleControl(throttle=throttle, brake=brake, steer=-steering / LOCK)


def vary(world: Any, hero: Any, driver: Driver) -> None:
    """Give the road a driver's share of its friction, and the hero their share of its speed."""
    if driver.friction != 1.0:
        weather = world.get_weather()
        weather.wetness = 100.0 - driver.friction * (100.0 - weather.wetness)
        world.set_weather(weather)
    if driver.speed != 1.0:
        hero.set_target_velocity(driver.speed * hero.get_velocity())


def drive(client: Any, scene: str, action: str, driver: Driver, times: Any) -> dict[str, Any]:
    """Drive one action from the scene's beginning; return what came of it."""
    world = client.load_world(scene)
    settings = world.get_settings()
    settings.synchronous_mode, settings.fixed_delta_seconds = True, DT
    before = world.apply_settings(settings)
    # Applying synchronous settings takes a tick or two by itself.
    taken = world.get_snapshot().frame - before
    (hero,) = (v for v in world.get_actors().filter("vehicle.*") if _role(v) == "hero")
    blueprint = world.get_blueprint_library().find("sensor.other.collision")
    sensor, hits = world.spawn_actor(blueprint, carla.Transform(), attach_to=hero), []
    sensor.listen(lambda event: hits.append((event.frame, _role(event.other_actor))))
    path, result, reaction = [], {"action": action, **driver._asdict()}, driver.reaction
    try:
        for _ in range(round(times.decision / DT) - taken):
            world.tick()
        hits.clear()
        vary(world, hero, driver)
        box, mu = hero.bounding_box.extent, 1.0 - world.get_weather().wetness / 100.0
        lane, off_road = Lane(world.get_map(), hero.get_transform()), False
        plan, travelled, is_acting = None, 0.0, False
        for step in range(round(times.horizon / DT)):
            place = lane.place(hero, 1.0 if step else driver.speed)
            if plan is None or (not is_acting and step * DT >= reaction - 1e-9):
                is_acting = step * DT >= reaction - 1e-9
                if step == 0 and "change" in action and target_lane(action, place) is None:
                    return {**result, "available": False}
                plan, travelled = (
                    plan_of(action if is_acting else "keep_speed", place, mu, box.y),
                    0.0,
                )
            else:
                travelled += place.speed * DT
            hero.apply_control(follow(plan, travelled, place, mu, times.base))
            world.tick()
            here = hero.get_transform()
            path.append((here.location.x, here.location.y, here.rotation.yaw))
            off_road = is_off_road(lane, here, box)
            if hits or off_road:
                break
        names = sorted({name for _, name in hits})
        return {**result, "available": True, "hit": names, "off_road": off_road, "path": path}
    finally:
        sensor.stop()
        sensor.destroy()


def is_off_road(lane: Lane, here: Any, box: Any) -> bool:
    """Return whether a corner of the hero is beside the road that its lane follows."""
    signs = ((1, 1), (1, -1), (-1, 1), (-1, -1))
    corners = [here.transform(carla.Location(x=a * box.x, y=b * box.y)) for a, b in signs]
    places = [lane.locate(corner) for corner in corners]
    low, high = (pick(offset for _, offset in places) for pick in (min, max))
    edges = [lane.edges(index) for index, _ in places]
    return any(low < right - SLACK or high > left + SLACK for right, left in edges)


def outcomes(client: Any, scene: str, times: Any) -> Iterator[dict[str, Any]]:
    """Yield the outcome of every action and driver."""
    drivers = [Driver(*one) for one in product(times.reaction, times.friction, times.speed)]
    for action in times.action or ACTIONS:
        for driver in drivers:
            # Who keeps the speed has nothing to react to.
            if action != "keep_speed" or driver.reaction == times.reaction[0]:
                found = drive(client, scene, action, driver, times)
                yield found
                if not found["available"]:
                    break


def _role(actor: Any) -> str:
    return str(actor.attributes.get("role_name", actor.type_id))


def _leftwards(lane: Any, own: Any) -> Any:
    """Return the next lane to the left as seen from the own lane; oncoming lanes look the other way."""
    return lane.get_left_lane() if lane.lane_id * own.lane_id > 0 else lane.get_right_lane()


def _line(waypoint: Any) -> tuple[float, float, float]:
    place = waypoint.transform
    return place.location.x, -place.location.y, -math.radians(place.rotation.yaw)


def _turn(one: Any, other: Any) -> float:
    apart = other.transform.rotation.yaw - one.transform.rotation.yaw
    return abs(_wrapped(math.radians(apart)))


def _wrapped(angle: float) -> float:
    return math.remainder(angle, 2.0 * math.pi)


def _slip(base: float, bend: float) -> float:
    return math.asin(max(-0.6, min(0.6, 0.5 * base * bend)))


def _stretch(speed: float, shift: float, mu: float, seconds: float, share: float) -> float:
    needed = math.sqrt(5.7735 * abs(shift) / min(2.5, share * mu * GRAVITY))
    return max(speed * max(seconds, needed), 4.0 * abs(shift), 1.0)


def main() -> int:
    """Drive all actions and print what came of them."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", help="id of the scene")
    parser.add_argument("--decision", type=float, required=True, help="s from the start")
    parser.add_argument("--horizon", type=float, default=8.0, help="s from the decision")
    parser.add_argument("--reaction", type=float, nargs="+", default=[0.2, 0.5, 0.8], help="s")
    parser.add_argument("--friction", type=float, nargs="+", default=[1.0], help="shares")
    parser.add_argument("--speed", type=float, nargs="+", default=[1.0], help="shares")
    parser.add_argument("--action", choices=ACTIONS, nargs="+", help="all by default")
    parser.add_argument("--base", type=float, default=2.7, help="the hero's wheelbase, m")
    parser.add_argument("--port", type=int, default=2000)
    parser.add_argument("--json", action="store_true", help="one line of JSON per drive")
    times = parser.parse_args()
    client = carla.Client("127.0.0.1", times.port, 1)
    client.set_timeout(60.0)
    safe: dict[str, bool] = {}
    for found in outcomes(client, times.scene, times):
        action = found["action"]
        is_safe = found["available"] and not found["hit"] and not found["off_road"]
        safe[action] = safe.get(action, True) and is_safe
        if times.json:
            print(json.dumps(found), flush=True)
            continue
        fate = "there is no such lane" if not found["available"] else "passes"
        if found.get("hit"):
            fate = f"hits {', '.join(found['hit'])}"
        elif found.get("off_road"):
            fate = "leaves the road"
        print(f"{action:18} after {found['reaction']:.1f} s: {fate}", flush=True)
    if not times.json:
        print("safe:", ", ".join(name for name, passed in safe.items() if passed) or "nothing")
    return 0


if __name__ == "__main__":
    sys.exit(main())
