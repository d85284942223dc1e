"""Jobs of simulation and their results, as they go to worker processes and come back."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from oodscen.data._claim import Claim
from oodscen.data._episode import MOMENTS, Episode
from oodscen.data._reactions import REACTIONS_S
from oodscen.data._scene import Scene
from oodscen.protocols import Camera
from oodscen.stages._pictures.video import View
from oodscen.stages._restaging.restage import Attempt
from oodscen.study._store import Store


@dataclass(frozen=True)
class Outputs:
    """Outputs to keep for every episode besides its record and frames."""

    traces: bool = False
    """Keep `traces/<scene>.parquet`: the ground truth of the approach and of every action."""
    annotations: bool = False
    """Keep `frames/<scene>/<moment>.json` with images of ids, classes and depth."""
    video: View | None = None
    """Keep `videos/<scene>.mp4`: the approach, then the first safe action."""


@dataclass(frozen=True)
class Job:
    """The settings of a worker that apply to all its scenes."""

    simulator: str
    """Registered name, or `module:attr`."""
    seed: int = 0
    outputs: Outputs = Outputs()
    twins: bool = False
    """Run every scene's ordinary twin right after it, while the map's scenery is built."""
    demands: bool = False
    """Make and run every scene's ordinary demand right after its twin."""
    protocol: Literal["ours", "paper"] = "ours"
    """Protocol as in `simulate`; frames of the paper's whole trace are named `whole-<moment>.jpg`."""
    restages: bool = False
    """Re-stage scenes whose hazard cannot be named at the decision, or in which all or none of the actions are
    safe."""
    camera: Camera = field(default_factory=Camera)
    """The camera of the frames."""
    moments: tuple[str, ...] = MOMENTS
    """The moments of the frames."""
    claims: Mapping[str, tuple[Claim, ...]] = field(default_factory=dict)
    """The claims of the texts by scenario, which no re-staged scene may contradict."""
    reaction: tuple[float, ...] = REACTIONS_S
    """Reaction times of the drivers who try every action, s."""
    horizon: float | None = None
    """Time for which an action is watched, s; the scenes' own if `None`."""
    is_rear: bool = False
    """Take only the picture from the rear window at the decision, `rear.jpg`, and try no action."""


@dataclass(frozen=True)
class SweepResult:
    """The result of one scene or ordinary drive."""

    episode: Episode
    frames: dict[str, bytes] = field(default_factory=dict)
    """JPEG data by moment."""
    files: dict[str, bytes] = field(default_factory=dict)
    """Further requested files, by path in the study."""
    restaged: Scene | None = None
    """The scene that was run instead of the given one."""
    tried: tuple[Attempt, ...] = ()
    """Other stagings that were tried without success."""
    demand: Scene | None = None
    """The scene, if this is the result of a demand."""

    def save(self, store: Store) -> None:
        """Write the frames and all further files to the paths that the episode names."""
        for moment, file in self.episode.frames.items():
            store.write(file, self.frames[moment])
        for file, data in self.files.items():
            store.write(file, data)
