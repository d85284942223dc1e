"""The bodies of a scene, placed at their start in the arrays of the kernels."""

import math
from collections.abc import Mapping

import numpy as np

from oodscen._seeding import stream
from oodscen.data._catalogue import BehaviourKind, Catalogue
from oodscen.data._scene import Actor, Scene
from oodscen.data._weather import DARK_DEG
from oodscen.driving._motion import columns as col
from oodscen.driving._motion.behaviours.codes import IN_WORLD, Code
from oodscen.driving._motion.behaviours.kernels import stand_in_world, stand_on_road
from oodscen.driving._motion.behaviours.row import BehaviourRow
from oodscen.driving._motion.behaviours.table import ATTACHED, BUILT_IN, QUICKNESS
from oodscen.driving._motion.bodies import Situation
from oodscen.driving._motion.car_following import curve_speed
from oodscen.driving._motion.key_tables import key_codes, key_table, key_traits, pose_first
from oodscen.driving._motion.keyframes import ABOARD
from oodscen.driving._motion.lane_keeping import grip
from oodscen.driving._motion.triggers import CODES
from oodscen.driving._roads.corridor import Corridor, ego_strip, neighbour_strip
from oodscen.driving._roads.track import for_kernels
from oodscen.driving._sight.weather import visual_range
from oodscen.numerics._exact import PI, TAU, cos, quantised, sincos, wrapped
from oodscen.numerics._kernels import seen

_HEADLAMPS_M = 75.0
"""Distance at which dipped headlamps reveal bodies without lamps, m."""
_LIT = frozenset({"vehicle", "cyclist", "work_zone", "signal"})
"""Categories with lamps or reflectors."""
_KEYED = BehaviourRow(Code.KEYED, "moves through the key poses of a motion made to order", ())


class PlacedBodies:
    """The arrays that hold the bodies of a scene, and the situation that the kernels read and write.

    Arguments and errors are those of `KinematicWorld`.
    """

    def __init__(
        self, corridor: Corridor, scene: Scene, catalogue: Catalogue, seed: int, *, dt: float
    ) -> None:
        self.corridor = corridor
        self.lane = ego_strip(corridor, scene.ego.lane)
        """The strip of the ego's lane."""
        self.bodies = catalogue.bodies(scene)
        """Id, asset and state of every body: the ego, then the actors in the scene's order."""
        self.ids = tuple(name for name, _, _ in self.bodies)
        self.rows = {name: row for row, name in enumerate(self.ids)}
        self.sizes = [(asset.length, asset.width) for _, asset, _ in self.bodies]
        count = len(self.ids)
        self._motions = {motion.id: motion for motion in scene.motions}
        keys, self._first_keys = key_table(scene.motions, count)
        self.state = np.zeros((count, col.STATE_WIDTH))
        self.traits = np.zeros((count + len(keys), col.TRAITS_WIDTH))
        if keys:
            self.traits[count:, : col.KEYS_WIDTH] = keys
        self.codes = np.zeros((count, col.CODES_WIDTH), dtype=np.int64)
        order = self._order(scene)
        far = quantised(visual_range(scene.weather))
        is_dark = scene.weather.sun_elevation_deg < DARK_DEG
        self.situation = Situation(
            track=for_kernels(corridor.track),
            state=seen(self.state),
            traits=seen(self.traits),
            codes=seen(self.codes),
            paths=seen(np.zeros((count, col.PATHS_WIDTH))),
            order=seen(np.array(order, dtype=np.int64)),
            dt=dt,
            friction=scene.weather.friction,
            visual_range=far,
            headlamp_range=min(far, _HEADLAMPS_M) if is_dark else far,
        )
        self.traits[:count, : col.WIDTH + 1] = self.sizes
        self.traits[:count, col.HEIGHT] = [asset.height for _, asset, _ in self.bodies]
        self._place_ego(scene.ego.speed)
        kinds = {kind.id: kind for kind in catalogue.for_scene(scene).behaviours}
        for row, actor in enumerate(scene.actors, start=1):
            self._place(row, actor, kinds[actor.behaviour.name], seed)
        for row in order:
            self._attach(row)

    def _order(self, scene: Scene) -> list[int]:
        """Return the actors' rows, each after the body that it belongs to."""
        owners = {
            row: self.rows[actor.behaviour.other]
            for row, actor in enumerate(scene.actors, start=1)
            if actor.behaviour.other is not None
        }
        waiting, order = list(range(1, len(self.ids))), []
        while waiting:
            ready = [row for row in waiting if owners.get(row) not in waiting]
            if not ready:
                names = ", ".join(self.ids[row] for row in waiting)
                raise ValueError(f"actors belong to each other in a ring: {names}")
            order += ready
            waiting = [row for row in waiting if row not in ready]
        return order

    def _place_ego(self, speed: float) -> None:
        self.codes[0, col.OTHER], self.codes[0, col.DIRECTION], self.codes[0, col.IS_LIT] = -1, 1, 1
        start = self.corridor.start
        self._stand(0, start, self.corridor.centre(self.lane, start), 0.0, speed)
        stand_in_world(self.situation, 0)

    def _place(self, row: int, actor: Actor, kind: BehaviourKind, seed: int) -> None:
        """Fill an actor's rows, and stand it at its start."""
        motion = self._motions.get(actor.behaviour.name)
        behaviour = BUILT_IN[kind.built_in] if motion is None else _KEYED
        is_held = behaviour.code in ATTACHED or (motion is not None and motion.frame == "other")
        if is_held and actor.behaviour.other is None:
            raise ValueError(f"{actor.id!r} needs another actor to do {actor.behaviour.name!r}")
        defaults = {name: parameter.default for name, parameter in kind.parameters.items()}
        parameters = {**defaults, **actor.behaviour.parameters}
        lane, target, heading = self._course(actor, behaviour.code, parameters)
        s = quantised(self.corridor.start + actor.placement.ahead_m)
        t = quantised(self.corridor.centre(lane, s) + actor.placement.offset_m)
        direction = 1 if cos(heading) >= 0.0 else -1
        self._fill_codes(row, actor, (behaviour.code, lane, target, direction))
        traits = self.traits[row]
        traits[col.OFFSET] = actor.placement.offset_m
        traits[col.VALUE] = actor.behaviour.trigger.value
        traits[col.QUICKNESS] = QUICKNESS[self.bodies[row][1].category]
        traits[col.HOME_S], traits[col.HOME_T] = s, t
        traits[col.FIRST :] = [parameters.get(name, 0.0) for name in col.PARAMETERS]
        if behaviour.has_chance:
            traits[col.PHASE] = float(stream(seed, "actor", actor.id).uniform(0.0, TAU))
        if motion is not None:
            self.codes[row, col.KEY :] = key_codes(motion, self._first_keys[motion.id])
            for column, value in key_traits(motion, actor.id, seed).items():
                traits[column] = value
        speed = parameters.get("speed", 0.0) if behaviour.moves_before_trigger else 0.0
        self._stand(row, s, t, heading, speed)
        if speed > 0.0 and behaviour.code not in IN_WORLD:
            fastest = float(curve_speed(self.situation, row, grip(self.situation)))
            self.state[row, col.SPEED] = quantised(min(speed, fastest))

    def _fill_codes(self, row: int, actor: Actor, course: tuple[Code, int, int, int]) -> None:
        """Store an actor's codes, from its behaviour, strips and direction."""
        other, trigger = actor.behaviour.other, actor.behaviour.trigger
        asset = self.bodies[row][1]
        self.codes[row, : col.KEY] = [
            *course,
            -1 if other is None else self.rows[other],
            CODES[trigger.kind],
            self.rows[trigger.actor or actor.id],
            asset.is_passable(actor.state),
            asset.category in _LIT,
        ]

    def _stand(self, row: int, s: float, t: float, heading: float, speed: float) -> None:
        """Put a body on the road, its trigger not fired."""
        state = self.state[row]
        state[col.S], state[col.T], state[col.HEADING] = s, t, heading
        state[col.SPEED], state[col.TRIGGERED] = quantised(speed), -1.0
        stand_on_road(self.situation, row)

    def _course(
        self, actor: Actor, code: Code, parameters: Mapping[str, float]
    ) -> tuple[int, int, float]:
        """Return an actor's strip, the strip that it may move to, and its heading relative to the road."""
        lane = target = neighbour_strip(self.corridor, self.lane, actor.placement.lane)
        if "lanes" in parameters:
            target = neighbour_strip(self.corridor, lane, round(parameters["lanes"]))
        heading = PI if code == Code.WRONG_WAY else actor.placement.heading_deg * PI / 180.0
        if self.corridor.strips[lane].direction < 0:
            heading += PI
        return lane, target, quantised(wrapped(heading))

    def _attach(self, row: int) -> None:
        """Store the pose of an actor relative to the body that holds it, if one does, and give it that one's speed."""
        code, other = self.codes[row, col.BEHAVIOUR], int(self.codes[row, col.OTHER])
        mine = self.state[row].tolist()
        is_held = pose_first(self.situation, row) if code == Code.KEYED else code in ATTACHED
        if not is_held:
            return
        its = self.state[other].tolist()
        sine, cosine = sincos(its[col.YAW])
        dx, dy = mine[col.X] - its[col.X], mine[col.Y] - its[col.Y]
        tail = 0.5 * self.sizes[other][0]
        hitch_x, hitch_y = dx + tail * cosine, dy + tail * sine
        pole = math.sqrt(hitch_x * hitch_x + hitch_y * hitch_y)
        askew = wrapped(mine[col.YAW] - its[col.YAW])
        traits = self.traits[row]
        traits[col.APART_X] = dx * cosine + dy * sine
        traits[col.APART_Y] = dy * cosine - dx * sine
        traits[col.APART_YAW] = askew
        traits[col.POLE] = max(pole, 0.5 * self.sizes[row][0])
        state, speed = self.state[row], its[col.SPEED]
        if code == Code.FALL:
            state[col.LIFT] = quantised(float(traits[col.DROP]))
            state[col.MEMORY : col.MEMORY + 2] = speed * cosine, speed * sine
        if code == Code.KEYED and state[ABOARD] == 0.0:
            speed = min(speed, float(traits[col.FASTEST]))
        if code != Code.OPEN_DOOR:
            state[col.SPEED] = quantised(speed * cos(wrapped(state[col.YAW] - its[col.YAW])))
