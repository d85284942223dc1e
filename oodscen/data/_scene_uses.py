"""Methods of a scene that do what higher floors can do with it.

They are the only functions that call upwards, and import what they need when they are called.
"""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, cast

from oodscen._io.study_files import refuse_own
from oodscen.data._claim import Claim
from oodscen.data._reactions import NOMINAL_REACTION_S
from oodscen.errors import Issue, SceneError

if TYPE_CHECKING:
    from pathlib import Path

    from oodscen._progress import Progress
    from oodscen.claims._findings import ClaimFinding
    from oodscen.data._catalogue import Catalogue
    from oodscen.data._scene import Scene
    from oodscen.driving._trace import Trace
    from oodscen.interchange._traces.osi_writing import Container
    from oodscen.interchange._writing.files import ScenarioFile
    from oodscen.interchange._writing.scenario import Mode, Target
    from oodscen.protocols import Camera, Driver, Encoder, Frame, Simulator, State
    from oodscen.stages._pictures.annotations import FrameAnnotations
    from oodscen.stages._pictures.birds_eye import BirdsEye
    from oodscen.stages._pictures.video import View


class SceneUses:
    """Checks, variants, pictures and files of a scene."""

    def check(self, catalogue: "Catalogue") -> list[Issue]:
        """Return the reasons why the scene, or its ordinary twin, cannot be staged.

        The vocabulary is checked first, then the room on the road. Then the world is simulated with a lane-keeping
        driver that ignores the hazard: the decision must come within 15 s, and until then the ego must touch nothing
        and stay on the road. In at least one of the three key moments the hazard must be visible or the weather must
        differ from the ordinary weather. No body may float, sink or stand inside another. Messages name actor, asset,
        pose and reason.

        Args:
            catalogue: The simulator's catalogue.

        Returns:
            One issue per fault, with its path in the scene; empty if the scene can be staged.
        """
        from oodscen.driving._sight.placement import check_scene

        scene = cast("Scene", self)
        return scene.misfits() or check_scene(scene, catalogue)

    def check_claims(
        self,
        claims: Sequence[Claim],
        catalogue: "Catalogue",
        trace: "Trace | None" = None,
        *,
        encoder: "Encoder | None" = None,
    ) -> "list[ClaimFinding]":
        """Compare every claim of a text with the scene, in their order.

        Each subject is assigned the actor that fits most of its claims, among those that the scene says stand for
        it or else those that its noun fits; subjects with the same name are different actors. Claims about several
        things (`count`), or about someone or something that the text does not name, only need one actor for which
        they are true.

        Args:
            claims: The claims of one text.
            catalogue: The catalogue of the scene's simulator; `check` finds no faults with it.
            trace: The ground truth of the scene, by default that of a drive on the kinematic world. A trace of
                `oodscen.simulate` ends at the decision, so later events go unseen.
            encoder: Compares the things of the text with the actors that the scene says stand for them.

        Returns:
            One finding per claim: it `holds`, `fails`, or is `open` if neither scene nor catalogue decides it.
        """
        from oodscen._members import conforming
        from oodscen.claims._checking import check_claims
        from oodscen.claims._matching import likeness_of

        if encoder is not None:
            conforming("encoder", encoder)
        likeness = likeness_of(encoder, catalogue)
        return check_claims(claims, fitting(self), catalogue, trace, likeness=likeness)

    def vary(
        self,
        catalogue: "Catalogue",
        count: int,
        *,
        claims: Sequence[Claim] = (),
        seed: int = 0,
    ) -> "list[Scene]":
        """Draw variants of the scene, uniformly from the ranges of its parameters, each checked.

        Args:
            catalogue: The catalogue of its assets and maps.
            count: Number of variants.
            claims: The claims of its text, which no variant contradicts.
            seed: Seed of the draws.

        Returns:
            The variants, `<scene>.v001` and so on, `<scene>.v001~demand` for a demand; fewer than asked for if too many draws fail the checks.
        """
        from oodscen.interchange._ranges import vary

        return vary(fitting(self), catalogue, count, claims=claims, seed=seed)

    def to_openscenario(
        self,
        catalogue: "Catalogue",
        *,
        mode: "Mode" = "replay",
        target: "Target" = "generic",
        action: str = "keep_speed",
        ego: bool = True,
        seed: int = 0,
        properties: Mapping[str, str] | None = None,
        simulator: "Simulator | None" = None,
        reaction_s: float = NOMINAL_REACTION_S,
        claims: Sequence[Claim] = (),
    ) -> "ScenarioFile":
        """Return the scene as OpenSCENARIO XML 1.2 with its OpenDRIVE map.

        `replay` has every body's course as rolled out. `reactive` has triggers as conditions on the ego, and recorded
        reactions that start with them; actors whose course cannot be exact for every ego are named in the notes.
        `logical` is the reactive scenario without the ego's course, and with its triggers, friction, visual range and
        the ego's first speed as parameters, whose ranges two further files give as a deterministic and a stochastic
        distribution; without them if no parameter has a range. Parameters of recorded courses (places and speeds of
        actors) have no place in these files: `vary` draws them.

        Args:
            catalogue: The catalogue of its assets and maps.
            mode: `replay`, `reactive` or `logical`.
            target: The player: `esmini` adds the property by which it follows polylines exactly;
                `carla-scenario-runner` gives version 1.0 with named actions, in mode `reactive` only.
            action: The ego's action after the decision; only a replay has one.
            ego: Write the ego's course; without it, the ego only stands at its start. Files for
                `carla-scenario-runner` and logical scenarios never have the course.
            seed: Seed of the scene's random streams, and of the stochastic distribution.
            properties: Further facts about the scene, by name, besides its ids and hazard; files for
                `carla-scenario-runner` have no properties.
            simulator: The simulator whose run is replayed, by default the kinematic world of the catalogue; the other
                modes always use that world, and note it where the simulator moves otherwise.
            reaction_s: Time from the decision until the ego acts in a replay, s.
            claims: The claims of its text, which every end of a range in a logical scenario keeps true.

        Raises:
            UnknownComponent: If there is no such mode, target or action.
            SceneError: If the catalogue, the road or the player refuses the scene.
            SimulatorError: If the simulator fails, whatever it raises.
            UsageError: If the player has no such mode, the ego lacks the lane that the action needs, or another thread
                uses the simulator.
        """
        from oodscen.interchange._writing.scenario import to_openscenario

        return to_openscenario(
            fitting(self),
            catalogue,
            mode=mode,
            target=target,
            action=action,
            ego=ego,
            seed=seed,
            properties=properties,
            simulator=simulator,
            reaction_s=reaction_s,
            claims=claims,
        )

    def record(
        self,
        simulator: "Simulator",
        path: "str | Path",
        *,
        driver: "Driver | str | None" = None,
        view: "View" = "both",
        seed: int = 0,
        camera: "Camera | None" = None,
        fps: float = 10.0,
        progress: "Progress | bool | None" = None,
    ) -> "Path":
        """Run the scene and write a video of it.

        The video continues to the scene's horizon after the decision, or until shortly after a collision or
        leaving the road.

        Args:
            simulator: The simulator to run it in.
            path: Path of the MP4 file.
            driver: Drives from the start, and is shown what it asks for, as in `drive`: a driver, or a name that
                `make_driver` takes. An action by its id is executed from the decision on, after a driver that is blind
                to the hazard, which also drives if this is left out.
            view: The ego's camera (`ego`), a bird's-eye view (`bird`), or both side by side (`both`).
            seed: Seed of the simulator's random streams.
            camera: By default the ego's dash camera.
            fps: Frames per second of the scene's time.
            progress: True for a progress bar, or a callable; it counts the steps of the simulator.

        Raises:
            UnknownComponent: When the view or the driver is unknown.
            MissingExtra: When OpenCV is not installed.
            SceneError: When the simulator refuses the scene.
            UsageError: When another thread uses the simulator; `driver` is not a driver, or returns no control; `fps`
                or `path` is invalid.
            FolderTaken: When the file would be one of a study's own, or lie below one of its folders.
            OodscenError: When the file cannot be written. An earlier file of that name stays then.
        """
        from pathlib import Path

        from oodscen._arguments import instance_of
        from oodscen.stages._pictures.video import record

        instance_of("path", path, str, Path)
        refuse_own(Path(path))
        return record(
            fitting(self),
            simulator,
            path,
            driver=driver,
            view=view,
            seed=seed,
            camera=camera,
            fps=fps,
            progress=progress,
        )

    def birds_eye(
        self, state: "State", catalogue: "Catalogue", *, size: int = 480, span_m: float = 72.0
    ) -> "BirdsEye":
        """Draw the road and all actors from above, with the ego heading upwards.

        As in the report, the ego is blue, the actors that make the scene OOD are amber, and what the ego touches is
        red.

        Args:
            state: State of the world in this scene.
            catalogue: The simulator's catalogue.
            size: Side of the square image, in pixels.
            span_m: Side of the shown area, in metres.

        Returns:
            uint8 [size, size, 3], red first; a notebook shows it as a picture.

        Raises:
            UsageError: If the state is one of another scene.
            MissingExtra: When OpenCV is not installed.
        """
        from oodscen.stages._pictures.birds_eye import birds_eye

        return birds_eye(state, fitting(self), catalogue, size=size, span_m=span_m)

    def annotate(
        self,
        frame: "Frame",
        state: "State",
        catalogue: "Catalogue",
        camera: "Camera | None" = None,
    ) -> "FrameAnnotations":
        """Return the ground truth of a frame: boxes, places, occlusion and truncation of every actor.

        Args:
            frame: A frame of this scene.
            state: State of the world at that moment.
            catalogue: The simulator's catalogue.
            camera: The camera that rendered the frame; by default the ego's dash camera.

        Raises:
            UsageError: If the state is one of another scene, or the frame cannot be one of the camera and the state.
        """
        from oodscen.stages._pictures.annotations import annotate

        return annotate(frame, state, fitting(self), catalogue, camera)

    def to_openlabel(self, catalogue: "Catalogue") -> dict[str, Any]:
        """Return the scene's tags as an ASAM OpenLABEL 1.0 document."""
        from oodscen.interchange._tags import openlabel

        return openlabel(fitting(self), catalogue)

    def to_osi(
        self,
        catalogue: "Catalogue",
        *,
        action: str = "keep_speed",
        seed: int = 0,
        container: "Container" = "osi",
        simulator: "Simulator | None" = None,
        reaction_s: float = NOMINAL_REACTION_S,
    ) -> bytes:
        """Return the scene's run as a trace of OSI ground truth, one message for each step.

        Every body is a moving object whose source reference names the entity (`entity_name:NAME`); the ego is the
        host.

        Args:
            catalogue: The catalogue of its assets and maps.
            action: The ego's action after the decision.
            seed: Seed of the scene's random streams.
            container: `osi` is the plain sequence of messages; `mcap` is a file of MCAP, with the OpenDRIVE file of
                the road in it.
            simulator: The simulator whose run is written, by default the kinematic world of the catalogue.
            reaction_s: Time from the decision until the ego acts, s.

        Raises:
            SceneError: If the catalogue or the road refuses the scene.
            UnknownComponent: If there is no such container or action.
            SimulatorError: If the simulator fails, whatever it raises.
            UsageError: If the ego lacks the lane that the action needs, or another thread uses the simulator.
            MissingExtra: If the packages for MCAP are not installed.
        """
        from oodscen.interchange._traces.osi_writing import osi_trace

        return osi_trace(
            fitting(self),
            catalogue,
            action=action,
            seed=seed,
            container=container,
            simulator=simulator,
            reaction_s=reaction_s,
        )


def fitting(scene: SceneUses) -> "Scene":
    """Return a scene whose values are ones that a scene can have.

    Raises:
        SceneError: If they are not, since `model_copy` changed them without checking.
    """
    scene = cast("Scene", scene)  # It alone has these methods.
    if issues := scene.misfits():
        raise SceneError(scene.id, issues)
    return scene
