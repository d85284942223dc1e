"""The scenes and ordinary twins that the episodes of an environment can have."""

from collections.abc import Sequence

from oodscen.data._pairing import scene_of, twin_id
from oodscen.data._scene import Scene
from oodscen.errors import UnknownComponent, UsageError


class SceneSet:
    """Copies of scenes, found by the ids of scenes and twins.

    Args:
        scenes: The scenes, with different ids.
        twins: True if `ids` has the scenes' twins as well.

    Raises:
        UsageError: If a scene has the id of another one's twin.
    """

    def __init__(self, scenes: Sequence[Scene], *, twins: bool) -> None:
        self._scenes = {scene.id: scene.model_copy(deep=True) for scene in scenes}
        ids: list[str] = []
        for scene in scenes:
            ids.append(scene.id)
            if twins and not scene.is_twin:
                twin = twin_id(scene.id)
                if twin in self._scenes:
                    raise UsageError(f"a scene has the id of another one's twin, {twin!r}")
                ids.append(twin)
        self.ids = tuple(ids)
        """The ids from which episodes are drawn, each twin after its scene."""

    def find(self, item_id: str) -> tuple[Scene, bool]:
        """Return the scene of an id, and whether the id is that of its twin, which need not be drawn.

        Raises:
            UnknownComponent: If there is no such scene or twin.
        """
        if item_id in self._scenes:
            return self._scenes[item_id], False
        scene = self._scenes.get(scene_of(item_id))
        if scene is None or scene.is_twin or item_id != twin_id(scene.id):
            raise UnknownComponent("scene", item_id[:80], self.ids)
        return scene, True
