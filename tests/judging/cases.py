"""Small studies of verdicts whose leaderboard can be worked out by hand."""

from collections.abc import Callable
from typing import Any

from oodscen.data._episode import ACTIONS, ActionOutcome, Episode
from oodscen.data._scenario import Scenario
from oodscen.data._verdict import Verdict

ROOT = "Scenario"


def scenario(path: int, index: int) -> Scenario:
    leaf = f"leaf-{path}"
    kind = "Environmental" if path % 2 else "Interactional"
    return Scenario(
        id=f"{leaf}-{index:03d}",
        text="x",
        leaf=leaf,
        path=(ROOT, kind, f"Family {path % 3}", f"Leaf {path}"),
    )


def episode(name: str, safe: tuple[str, ...]) -> Episode:
    actions = {
        action: ActionOutcome(safe=action in safe, unavailable=action == "pull_over")
        for action in ACTIONS
    }
    return Episode(id=name, scene_id=name, status="ok", actions=actions)


class Case:
    """So many paths with so many scenes and their twins; `stop` is safe in scenes, all in twins."""

    def __init__(self, paths: int = 6, per_path: int = 4) -> None:
        self.scenarios = [scenario(p, i) for p in range(paths) for i in range(per_path)]
        self.episodes = [
            episode(name, safe)
            for one in self.scenarios
            for name, safe in (
                (one.id, ("stop", "emergency_brake")),
                (f"{one.id}~twin", tuple(a for a in ACTIONS if a != "pull_over")),
            )
        ]

    def verdicts(
        self, model: str, say: Callable[[int, bool], dict[str, Any]], kind: str = "model"
    ) -> list[Verdict]:
        """Ask `say(index of the scene, is it the twin)` for the fields of every verdict."""
        found = []
        for row, one in enumerate(self.episodes):
            fields = say(row // 2, one.is_twin)
            action = fields.get("action")
            if action is not None:
                fields = {"action_is_safe": one.actions[action].safe, **fields}
            found.append(
                Verdict.parse(
                    {
                        "id": f"{one.scene_id}@{model}", "scene_id": one.scene_id, "model": model,
                        "kind": kind, "is_ordinary": one.is_twin, **fields,
                    }
                )
            )  # fmt: skip
        return found
