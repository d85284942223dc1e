"""The frames of an episode on disk, shown only if they are those that were recorded."""

from collections.abc import Mapping

from oodscen.data._episode import Episode
from oodscen.data._messages import Image
from oodscen.errors import DataError, Issue
from oodscen.protocols import Camera
from oodscen.study._store import Store


def frames_of(
    store: Store, files: Mapping[str, str], recorded: Mapping[str, str], camera: Camera
) -> dict[str, Image]:
    """Return the frames of an episode by moment.

    Args:
        store: The study's folder.
        files: `Episode.frames`.
        recorded: `Episode.file_sha256`.
        camera: The camera of the frames.

    Raises:
        DataError: With every frame that cannot be read, is not the recorded one, has another size than the camera's
            pictures, or cannot be shown; or if one lies outside the study.
    """
    frames, faults = dict[str, Image](), list[str]()
    for moment, file in files.items():
        try:
            image = Image.from_file(store.inside(file), file)
        except OSError as error:
            faults.append(f"{file} cannot be read: {error.strerror or error}")
            continue
        frames[moment] = image
        if fault := _fault(image, recorded, camera):
            faults.append(fault)
    if faults:
        raise DataError("frames", [Issue("", fault) for fault in faults], source=str(store.folder))
    return frames


def rear_view_of(store: Store, scene_id: str, behind: Episode | None, camera: Camera) -> Image:
    """Return the view from the rear window at the decision of a drive.

    Args:
        store: The study's folder.
        scene_id: The drive.
        behind: The run in which the view was taken, if it was.
        camera: The camera of the frames.

    Raises:
        DataError: If the view was not taken, or for the reasons of `frames_of`.
    """
    if behind is None or not behind.frames:
        lacks = f"{scene_id} has no view to the rear; the same `oodscen run OUT` takes it"
        raise DataError("frames", [Issue("", lacks)], source=str(store.folder))
    return frames_of(store, behind.frames, behind.file_sha256, camera)["last"]


def _fault(image: Image, recorded: Mapping[str, str], camera: Camera) -> str:
    """Return why a frame cannot be shown, or an empty string."""
    if recorded.get(image.name, image.sha256) != image.sha256:
        return f"{image.name} is not the recorded frame: its SHA-256 differs from that of episodes.jsonl"
    return image.fault((camera.width, camera.height))
