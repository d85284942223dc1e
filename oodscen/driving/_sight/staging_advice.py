"""Advice to a stager whose hazard cannot be named at the decision, from a trial run of the kinematic world."""

from collections.abc import Sequence

from oodscen._abilities import ChecksScenes, own_issues
from oodscen.data._catalogue import Catalogue
from oodscen.data._scene import Scene
from oodscen.data._sighting import LEAST_SIZE_PX, Sighting
from oodscen.driving._motion.actions import CODES, Cruise, action_driver, is_available
from oodscen.driving._motion.triggers import value_in
from oodscen.driving._motion.world import KinematicWorld
from oodscen.driving._roads.building import load_corridor
from oodscen.driving._sight.decision_view import drawn
from oodscen.driving._sight.placement import APPROACH_S, check_scene
from oodscen.driving._sight.scene_checks import PlacedBody, bodies
from oodscen.driving._sight.visibility import Eye
from oodscen.errors import Issue
from oodscen.protocols import Camera, Simulator, camera_for

LATEST_S = 6.0
"""Greatest delay of a decision, s."""
LOOK_S = 0.2
"""Interval between the later moments that are tried, s."""


def visibility_issues(scene: Scene, catalogue: Catalogue) -> list[Issue]:
    """Return at most one issue: why a viewer cannot name a valid scene's hazard at its decision, and the remedy.

    The kinematic world is run without rendering, so contrast and light are not judged. A scene is accepted
    as it is if a later decision makes its hazard large enough while some action is still safe: running the
    scene moves the decision there by itself. The camera is one that the simulator can draw with.
    """
    if scene.is_ordinary or not scene.hazard.actors:
        return []
    camera = camera_for(catalogue)
    corridor = load_corridor(scene.map, catalogue)
    world = KinematicWorld(corridor, scene, catalogue, 0)
    driver = Cruise()
    while not world.is_due(scene.decision) and world.time < APPROACH_S:
        world.step(driver.act(world.observe()))

    def look() -> Sighting | None:
        return drawn(scene, bodies(scene, catalogue, world.poses()), corridor, camera)

    now = look()
    if now is None or not now.faults:
        return []
    cast = bodies(scene, catalogue, world.poses())
    large: tuple[Sighting, float] | None = None
    steps = round(LOOK_S / world.dt)
    for step in range(round(LATEST_S / world.dt)):
        if _has_crashed(world):
            break
        later = look() if step % steps == 0 else None
        if later is not None and not later.faults:
            large = large or (later, value_in(scene.decision, world.state(), corridor))
            if _has_way_out(world, scene):
                return []
        world.step(driver.act(world.observe()))
    row = next(row for row, actor in enumerate(scene.actors) if actor.id == now.actor)
    fault = f"{_fault(now, cast, row + 1, camera)}; {_remedy(scene, large)}"
    return [Issue(f"actors[{row}]", fault)]


def _fault(now: Sighting, cast: Sequence[PlacedBody], row: int, camera: Camera) -> str:
    """Return what is wrong with the look of a body at the decision."""
    actor = f"{now.actor!r} ({cast[row].asset})"
    if "outside" in now.faults:
        return f"{actor} is outside the camera's view at the decision"
    if "hidden" in now.faults:
        eye = Eye(camera, cast[0].solid)
        others = [body for other, body in enumerate(cast) if other not in (0, row)]
        shares = {body.id: eye.see(cast[row].solid, [body.solid]).hidden for body in others}
        cause = max(shares, key=lambda name: shares[name], default="")
        behind = f"{cause!r}" if cause and shares[cause] > 0.0 else "a crest of the road"
        return f"{100.0 * now.hidden:.0f} % of {actor} is hidden behind {behind} at the decision"
    return (
        f"at the decision {actor} is {now.distance_m:.0f} m away and as large as {now.size_px:.0f} pixels in a picture of "
        f"480 rows: a viewer needs {LEAST_SIZE_PX:.0f} to name it"
    )


def _remedy(scene: Scene, large: tuple[Sighting, float] | None) -> str:
    """Return what would make the hazard nameable while a safe action is left."""
    if large is None:
        return (
            "before the ego reaches it, it is never seen well enough: place it nearer to the ego's way and clear of "
            "other things, or use something larger; if the text allows neither, say so in `cannot_show`"
        )
    seen, value = large
    return (
        f"{seen.distance_m:.0f} m away it is seen well enough ({scene.decision.kind} {value:.3g}), but no action is safe any "
        f"more from there: decide there with a slower ego than {scene.ego.speed:g} m/s or a free lane, or use something "
        "larger; if the text allows none of these, say so in `cannot_show`"
    )


def _has_crashed(world: KinematicWorld) -> bool:
    state = world.state()
    return state.off_road or bool(state.contacts)


def _has_way_out(world: KinematicWorld, scene: Scene) -> bool:
    """Return whether some action is safe from the current state, to which the world returns."""
    start = world.snapshot()
    for action in CODES:
        may_pass = _may_pass(world, scene, action)
        world.restore(start)
        if may_pass:
            return True
    return False


def _may_pass(world: KinematicWorld, scene: Scene, action: str) -> bool:
    """Execute an action up to the scene's horizon; return whether the ego touches nothing and stays on the road."""
    if not is_available(action, world.observe()):
        return False
    driver = action_driver(action)
    for _ in range(max(1, round(scene.horizon_s / world.dt))):
        world.step(driver.act(world.observe()))
        if _has_crashed(world):
            return False
    return True


class AdvisingCheck:
    """`check_scene`, the simulator's own check, and once per scene the advice of `visibility_issues`.

    A hazard that cannot be named is no reason to refuse a scene for good: only its first valid staging gets the
    advice, later ones are accepted.
    """

    def __init__(self, simulator: Simulator | None = None) -> None:
        """Start without any advice; the simulator is the one that will run the scenes."""
        self._own = simulator if isinstance(simulator, ChecksScenes) else None
        self._advised: set[str] = set()

    def __call__(self, scene: Scene, catalogue: Catalogue) -> list[Issue]:
        """Return the faults of a scene; if it has none, the advice, unless it was given before."""
        issues = check_scene(scene, catalogue)
        if not issues and self._own is not None:
            issues = own_issues(self._own, scene)
        if issues or scene.id in self._advised:
            return issues
        self._advised.add(scene.id)
        return visibility_issues(scene, catalogue)
