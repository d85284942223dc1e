"""The environment `oodscen/Scene-v0`: drive the ego of a scene."""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from oodscen._arguments import checked, instance_of
from oodscen._display import Brief
from oodscen._members import close, working
from oodscen._numbers import seed_number
from oodscen.data._scene import Scene
from oodscen.driving._base_simulator import render_checked
from oodscen.driving._checked_simulator import checked_simulator
from oodscen.errors import SimulatorError, UnknownComponent, UsageError
from oodscen.gymnasium._acting import ActionDecoder
from oodscen.gymnasium._driver_policy import DriverPolicy
from oodscen.gymnasium._episode import PreparedScene, RunningScene
from oodscen.gymnasium._extra import gymnasium
from oodscen.gymnasium._interface import ActionKind, Interface, ObservationKind, nearest_steps
from oodscen.gymnasium._observing import picture
from oodscen.gymnasium._reward import Reward
from oodscen.gymnasium._scene_set import SceneSet
from oodscen.gymnasium._scenes import chosen_scenes
from oodscen.gymnasium._simulator_use import claim, release
from oodscen.protocols import Camera, Driver, Frame, Observation, Simulator, State, camera_for
from oodscen.study._study import Study

_ROUNDING_S = 1e-6
"""Difference of two times that comes of rounding, also in single precision, s."""


class SceneEnv(Brief, gymnasium.Env[Any, Any]):
    """Drives the ego of a scene from its start to its horizon, as `oodscen.drive` does.

    An episode is one scene. It terminates when the ego touches a body or leaves the drivable road, and is
    truncated when the scene's horizon is over. `reset(seed=...)` seeds the choice of the scenes; the motion
    of a scene is always that of the study's seed. `reset(options={"scene": ID})` chooses one.

    `info` has the scene's id (`scene`), the `time`, s, `collision` (a touch), `collisions` (the ids of the
    touched bodies), `off_road`, `ttc_s` (least time to collision with any body, s, infinite without one),
    `gap_m` (least gap, m), `speed`, m/s, `progress_m` (distance along the road), `step_s` (time for which an
    action holds, s), and after a step the `reward_terms`.

    Args:
        study: A finished study or its folder; without one and without `scenes`, three example scenes.
        scenes: Scenes in place of a study's.
        simulator: Name or object in place of the study's simulator; without a study, `flat`. It is closed with
            the environment, and no other open environment may use the same object.
        seed: Seed of the motion in scenes in place of the study's.
        twins: True to draw the scenes' ordinary twins as well.
        observation: `state`, `frame` or `both`.
        actions: `continuous` or `discrete`.
        neighbours: Number of neighbours in the state.
        camera: The camera of frames; by default the dash camera with 128 x 96 pixels.
        step_s: Time for which an action holds, s: a multiple of the simulator's step, by default the one
            that is nearest to 0.1 s.
        reward: Weights of the reward by name, in place of the defaults: `progress` (1), `offset` (-0.05), `braking`
            (-0.5), `critical` (-1), `collision` (-20) and `off_road` (-20).
        render_mode: `rgb_array`, or none.

    Raises:
        UsageError: If an argument makes no sense.
        SceneError: If a scene has values that no scene can have.
        StudyMissing: If the folder holds no study.
    """

    _repr_fields = ("simulator", "interface", "scene_ids")

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 10}

    @checked
    def __init__(
        self,
        study: str | Path | Study | None = None,
        *,
        scenes: Sequence[Scene] | None = None,
        simulator: str | Simulator | None = None,
        seed: int | None = None,
        twins: bool = False,
        observation: ObservationKind = "state",
        actions: ActionKind = "continuous",
        neighbours: int = 6,
        camera: Camera | None = None,
        step_s: float | None = None,
        reward: Mapping[str, float] | None = None,
        render_mode: str | None = None,
    ) -> None:
        self.interface = Interface(observation, actions, neighbours, camera, step_s)
        modes = self.metadata["render_modes"]
        if render_mode not in (None, *modes):
            raise UnknownComponent("render mode", str(render_mode)[:80], modes)
        self.observation_space = self.interface.observation_space
        self.action_space = self.interface.action_space
        self.render_mode = render_mode
        self.reward = Reward.of(reward or {})
        chosen, self.simulator, study_seed = chosen_scenes(study, scenes, simulator)
        self._checked_simulator = checked_simulator(self.simulator)
        self._seed = study_seed if seed is None else seed_number(seed)
        self._scenes = SceneSet(chosen, twins=twins)
        self.scene_ids = self._scenes.ids
        """The ids that an episode can have by chance."""
        self._steps_per_action = self._count_steps()
        self.interface.step_s = self._steps_per_action * self.simulator.dt
        frames_per_s = max(1, round(1.0 / self.interface.step_s))
        self.metadata = {**self.metadata, "render_fps": frames_per_s}
        self._prepared: dict[str, PreparedScene] = {}
        self._decoder = ActionDecoder(actions)
        self._episode: RunningScene | None = None
        self._is_over = True
        self.episode = 0
        """Number of episodes that have begun."""
        claim(self)

    def __getstate__(self) -> Any:
        """Return what is copied or pickled.

        Raises:
            UsageError: After `reset`: the simulator then holds a scene of this process.
        """
        if self._episode is not None:
            raise UsageError(
                "an environment cannot be copied or pickled after reset, since its simulator holds a scene of this "
                "process; pass a function that makes one"
            )
        return super().__getstate__()

    def _count_steps(self) -> int:
        """Return the number of the simulator's steps for which an action holds."""
        dt, seconds = self.simulator.dt, self.interface.step_s
        steps = nearest_steps(seconds, dt)
        if seconds is not None and abs(steps * dt - seconds) > _ROUNDING_S:
            raise UsageError(
                f"step_s is {seconds:g} s, not a multiple of the simulator's step of {dt:g} s; "
                f"try {steps * dt:g}"
            )
        return steps

    @checked
    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Begin an episode.

        Args:
            seed: Seed of the choice of scenes from now on.
            options: `scene`, the id of a scene; `<id>~twin` for a twin.

        Raises:
            UsageError: If an option or a scene is unknown.
            SceneError: If the simulator refuses the scene.
            SimulatorError: If the simulator fails.
        """
        super().reset(seed=seed)
        unknown = sorted({str(name) for name in options or {}} - {"scene"})
        if unknown:
            raise UnknownComponent("option of reset()", unknown[0], ["scene"])
        name = (options or {}).get("scene")
        if name is None:
            name = self.scene_ids[int(self.np_random.integers(len(self.scene_ids)))]
        claim(self)
        self._is_over = True
        prepared = self._prepare(str(name))
        with working("simulator", self.simulator.name):
            episode = self._episode = RunningScene.begin(
                prepared, self._checked_simulator, self._seed
            )
        self._decoder = ActionDecoder(self.interface.actions)
        self.episode += 1
        if episode.is_lost:
            raise SimulatorError(
                f"the scene {prepared.scene.id!r} begins with a collision or off the road"
            )
        self._is_over = False
        return self._observe(episode), self._info(episode, None)

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Hold an action for one step of the environment.

        Raises:
            UsageError: If the action is not in the action space, the episode is over, or this is a copy of an
                environment that uses the simulator.
            SimulatorError: If the simulator fails.
        """
        episode = self._episode
        if self._is_over or episode is None:
            raise UsageError(
                "SceneEnv.step(): call reset() first; the episode is over or has not begun"
            )
        claim(self)
        self._decoder.begin(action, episode.observation, "SceneEnv.step()")
        self._is_over = True  # Also if the simulator fails: its state is unknown then.
        terms: dict[str, float] = {}
        for _ in range(self._steps_per_action):
            before, begin_m, begin_speed = episode.state, episode.place_m, episode.speed
            with working("simulator", self.simulator.name):
                episode.advance(self._decoder.control(episode.observation))
            info = self._info(episode, before)
            seconds = episode.state.time - before.time
            added = self.reward.terms(
                seconds,
                progress=(episode.place_m - begin_m) / (episode.initial_speed * seconds),
                offset_m=episode.observation.offset_m,
                deceleration=(begin_speed - episode.speed) / seconds,
                ttc_s=info["ttc_s"],
                collision=info["collision"],
                off_road=info["off_road"],
            )
            terms = {name: terms.get(name, 0.0) + term for name, term in added.items()}
            if episode.is_lost or episode.is_at_horizon:
                break
        terminated = episode.is_lost
        truncated = not terminated and episode.is_at_horizon
        self._is_over = terminated or truncated
        info["reward_terms"] = terms
        return self._observe(episode), math.fsum(terms.values()), terminated, truncated, info

    def render(self) -> NDArray[np.uint8] | None:
        """Return the dash camera's picture, 640 x 480, or `None` without a render mode."""
        if self.render_mode is None:
            return None
        return picture(self.look(Camera()), Camera(), self._frame_source)

    def close(self) -> None:
        """Close the simulator; may be called twice, and a later `reset` opens it again."""
        self._is_over = True
        release(self)
        close(self.simulator)

    @property
    def state(self) -> State | None:
        """The true state; `None` before the first reset."""
        return None if self._episode is None else self._episode.state

    @property
    def driver_observation(self) -> Observation | None:
        """The observation of a driver, not of the environment; `None` before the first reset."""
        return None if self._episode is None else self._episode.observation

    def look(self, camera: Camera) -> Frame:
        """Return a frame of the current state; of a camera that looks ahead, one that sees from above only keeps the size.

        Raises:
            UsageError: Before the first reset, or if it is no camera.
        """
        if self._episode is None:
            raise UsageError("SceneEnv: call reset() first")
        instance_of("camera", camera, Camera)
        with working("simulator", self.simulator.name):
            camera = camera_for(self._checked_simulator.catalogue(), camera)
            return render_checked(self.simulator, camera, len(self._episode.state.ids))

    @checked
    def policy(self, driver: Callable[[], Driver] | str) -> DriverPolicy:
        """Return a policy by which a driver acts here: a function of the observation, with `predict` too.

        The driver sees what drivers see, the true state and its own observation. Every episode gets a new one.

        Args:
            driver: A class or function that makes a driver, or a name that `make_driver` takes.

        Raises:
            UsageError: If the actions are discrete, or there is no such driver.
        """
        return DriverPolicy(driver, self)

    @property
    def _frame_source(self) -> str:
        """The method that made a frame, for messages."""
        return f"render() of the simulator {self.simulator.name!r}"

    def _prepare(self, name: str) -> PreparedScene:
        """Return a scene or twin, prepared once."""
        if name not in self._prepared:
            scene, is_twin = self._scenes.find(name)
            with working("simulator", self.simulator.name):
                self._prepared[name] = PreparedScene.of(
                    scene, self._checked_simulator, self._seed, is_twin=is_twin
                )
        return self._prepared[name]

    def _observe(self, episode: RunningScene) -> Any:
        """Return the observation of the environment."""
        frame = self.look(self.interface.camera) if self.interface.wants_frames else None
        return self.interface.observe(episode.state, episode.observation, frame, self._frame_source)

    def _info(self, episode: RunningScene, before: State | None) -> dict[str, Any]:
        return {**episode.info(before), "step_s": self.interface.step_s}
