"""Coverage of a tree: texts, scenes, episodes and outcomes, node by node."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, ClassVar, Literal, TypeVar

from oodscen._words.decimals import fine_percent
from oodscen.data._base import Data
from oodscen.data._episode import Episode
from oodscen.data._pairing import scene_of
from oodscen.data._scenario import Scenario
from oodscen.data._scene import Scene
from oodscen.tree._labels import same_words

if TYPE_CHECKING:
    from oodscen.study._study import Study
    from oodscen.tree._scenario_tree import ScenarioTree

Kind = Literal["root", "class", "family", "leaf"]
Lack = Literal["", "text", "scene", "episode", "choice"]


class NodeTally(Data):
    """The counts at and below one node. Twins are counted separately."""

    id: str
    label: str
    kind: Kind
    depth: int
    leaves: int
    """Number of leaves at or below the node."""
    texts: int = 0
    """Number of texts that differ in more than case and spaces."""
    scenes: int = 0
    episodes: int = 0
    """Number of episodes that ran."""
    failed: int = 0
    """Number of episodes that failed."""
    safe: int = 0
    """Number of safe actions over all episodes."""
    unsafe: int = 0
    """Number of available actions that were not safe."""
    mixed: int = 0
    """Number of episodes in which the choice matters: some action is safe and some is not."""
    twins: int = 0
    """Number of episodes of ordinary twins that ran."""
    holes: int = 0
    """Number of leaves at or below the node that lack something."""
    exposure: float | None = None
    """Share of the tree's meetings at or below the node, by estimated rarity; `None` if no leaf there has one."""
    lacks: Lack = ""
    """For a leaf, the first thing it lacks: a text, a scene, an episode that ran, or one in which
    the choice matters."""


class Coverage(Data):
    """Coverage of a tree, with its holes."""

    noun: ClassVar[str] = "coverage report"

    schema_version: Literal[1] = 1
    rows: tuple[NodeTally, ...] = ()
    """One row per node, in tree order; each includes the nodes below it."""
    elsewhere: int = 0
    """Number of texts, scenes and episodes that belong to no node of the tree."""

    @property
    def holes(self) -> tuple[NodeTally, ...]:
        """Leaves that lack something, in tree order."""
        return tuple(row for row in self.rows if row.lacks)

    @property
    def has_gaps(self) -> bool:
        """Return whether a leaf lacks something, or there is no leaf at all."""
        return bool(self.holes) or not self.of("leaf")

    @property
    def exposed_holes(self) -> float | None:
        """Share of the tree's meetings that falls to leaves that lack something; `None` if no leaf has an exposure."""
        if all(row.exposure is None for row in self.rows):
            return None
        # What is stored is rounded, and need not add up to one.
        everything, holes = (
            sum(row.exposure or 0.0 for row in rows) for rows in (self.of("leaf"), self.holes)
        )
        return holes / everything if everything else 0.0

    def of(self, kind: Kind) -> tuple[NodeTally, ...]:
        """Return the rows of one kind."""
        return tuple(row for row in self.rows if row.kind == kind)

    def __str__(self) -> str:
        head = f"{'':52} leaves  texts scenes    ran failed   safe unsafe  mixed  twins  holes"
        lines = [head, *map(_table_line, self.rows)]
        for lack, words in LACKS.items():
            labels = [row.label for row in self.holes if row.lacks == lack]
            if labels:
                lines.append(f"{len(labels)} {words}: {'; '.join(labels)}")
        if self.holes and self.exposed_holes is not None:
            unknown = sum(row.exposure is None for row in self.holes)
            others = f"; {unknown} more cannot be told" if unknown else ""
            lines.append(
                f"leaves with holes: {fine_percent(self.exposed_holes)} of what a driver would meet{others}"
            )
        if self.elsewhere:
            lines.append(f"{self.elsewhere} texts, scenes and episodes belong to no leaf")
        return "\n".join(lines)


def _table_line(row: NodeTally) -> str:
    name = f"{'  ' * min(row.depth, 8)}{row.label}"
    if len(name) > 52:
        name = f"{name[:51]}…"
    numbers = "".join(f"{getattr(row, count):7}" for count in COUNTS)
    lacks = f"  lacks {row.lacks}" if row.lacks else ""
    return f"{name:52}{numbers}{lacks}"


LACKS: Mapping[Lack, str] = {
    "text": "without a text",
    "scene": "with a text but no scene",
    "episode": "with a scene but no episode that ran",
    "choice": "with episodes in which every action, or none, is safe",
}
"""Descriptions of the items that a leaf can lack, by their names in `NodeTally.lacks`."""
COUNTS = (
    "leaves",
    "texts",
    "scenes",
    "episodes",
    "failed",
    "safe",
    "unsafe",
    "mixed",
    "twins",
    "holes",
)
"""The counts of a `NodeTally`, in the order of a report's columns."""


def coverage(
    tree: "ScenarioTree",
    *,
    texts: Iterable[Scenario] = (),
    scenes: Iterable[Scene] = (),
    episodes: Iterable[Episode] = (),
    per_km: Mapping[str, float] | None = None,
) -> Coverage:
    """Count the texts, scenes and episodes that cover each node of a tree.

    A text belongs to the node that it names, usually a leaf, a scene to the node of its text, and an
    episode to the node of its scene. Repeated ids are skipped.

    Args:
        tree: Any tree.
        texts: The texts; leave out if only the tree is of interest.
        scenes: The staged scenes.
        episodes: The episodes of the scenes, including those of twins.
        per_km: Meetings per kilometre by leaf, which weight the nodes.
    """
    texts, scenes = _without_repeats(texts), _without_repeats(scenes)
    leaf_of_text: dict[str | None, str] = {text.id: text.leaf for text in texts}
    leaf_of_scene = {scene.id: leaf_of_text.get(scene.scenario_id) for scene in scenes}
    counts: dict[str | None, Counter[str]] = {node.id: Counter() for node in tree.nodes}
    wordings: dict[str, set[str]] = defaultdict(set)
    elsewhere = 0
    for text in texts:
        if text.leaf in counts:
            wordings[text.leaf].add(same_words(text.text))
        else:
            elsewhere += 1
    for node_id, different in wordings.items():
        counts[node_id]["texts"] = len(different)
    for scene in scenes:
        leaf = leaf_of_scene[scene.id]
        if leaf in counts:
            counts[leaf]["scenes"] += 1
        else:
            elsewhere += 1
    for episode in _without_repeats(episodes):
        leaf = leaf_of_scene.get(scene_of(episode.scene_id))
        if leaf in counts:
            _count_episode(counts[leaf], episode)
        else:
            elsewhere += 1
    return Coverage(rows=_rows(tree, counts, per_km or {}), elsewhere=elsewhere)


def study_coverage(study: "Study", tree: str = "simulatable") -> Coverage:
    """Count the texts, scenes and episodes of a study for each node of one of its trees.

    Args:
        study: A study, finished or not; parts that it does not hold yet count as missing.
        tree: `initial`, `diverse` or `simulatable`. For the two larger trees, the texts of the text
            sets count as well as the scenarios.

    Raises:
        UnknownComponent: If the tree has another name.
        DataError: If a file cannot be read, or is malformed.
    """
    texts = list(study.scenarios)
    if tree != "simulatable":
        # Each text set numbers its texts from the start, so its ids may collide with those of other
        # sets.
        for size in study.config.sets:
            texts += [
                text.model_copy(update={"id": f"{size}.{text.id}"}) for text in study.texts(size)
            ]
    return coverage(
        study.tree(tree),
        texts=texts,
        scenes=study.scenes,
        episodes=study.episodes,
        per_km=study.exposure,
    )


_Item = TypeVar("_Item", Scenario, Scene, Episode)


def _without_repeats(items: Iterable[_Item]) -> list[_Item]:
    """Return the first item of each id."""
    by_id: dict[str, _Item] = {}
    for item in items:
        by_id.setdefault(item.id, item)
    return list(by_id.values())


def _count_episode(count: Counter[str], episode: Episode) -> None:
    if episode.is_ordinary:
        if episode.is_twin and episode.status == "ok":
            count["twins"] += 1
    elif episode.status != "ok":
        count["failed"] += 1
    else:
        count["episodes"] += 1
        count["safe"] += len(episode.safe_set)
        count["unsafe"] += sum(outcome.is_unsafe for outcome in episode.actions.values())
        count["mixed"] += episode.is_decidable


def _rows(
    tree: "ScenarioTree", counts: Mapping[str | None, Counter[str]], per_km: Mapping[str, float]
) -> tuple[NodeTally, ...]:
    """Return the rows of all nodes, after the counts of each leaf are added to those of the nodes above it."""
    order = list(tree.walk())
    leaves = [leaf.id for leaf in tree.leaves]
    lacks = {leaf: _lack(counts[leaf]) for leaf in leaves}
    for leaf, lack in lacks.items():
        counts[leaf].update(leaves=1, holes=int(bool(lack)))
    meetings = {leaf: per_km[leaf] for leaf in leaves if leaf in per_km}
    total = sum(meetings.values())
    for node, _ in reversed(order):
        if node.parent is None:
            continue
        counts[node.parent].update(counts[node.id])
        if node.id in meetings:
            meetings[node.parent] = meetings.get(node.parent, 0.0) + meetings[node.id]
    return tuple(
        NodeTally(
            id=node.id,
            label=node.label,
            kind=_kind(depth, is_leaf=node.id in lacks),
            depth=depth,
            exposure=round(meetings[node.id] / total, 6)
            if node.id in meetings and total > 0.0
            else None,
            lacks=lacks.get(node.id, ""),
            **{name: counts[node.id][name] for name in COUNTS},
        )
        for node, depth in order
    )


def _kind(depth: int, *, is_leaf: bool) -> Kind:
    if depth == 0:
        return "root"
    if depth == 1:
        return "class"
    return "leaf" if is_leaf else "family"


def _lack(count: Counter[str]) -> Lack:
    if not count["texts"]:
        return "text"
    if not count["scenes"]:
        return "scene"
    if not count["episodes"]:
        return "episode"
    return "" if count["mixed"] else "choice"
