"""Describe the paths of a tree: distinct texts for each (paper, section III-B)."""

from collections.abc import Mapping, Sequence

import numpy as np

from oodscen.ask import ask
from oodscen.concurrency import as_finished
from oodscen.paper import PER_PATH
from oodscen.prompts import DescribePath
from oodscen.protocols import LLM, Encoder
from oodscen.scenario import Scenario
from oodscen.tree import ScenarioTree


class Describer:
    """Asks the tree-LLM for texts along each path; near duplicates are drawn again.

    Args:
        llm: The tree-LLM.
        encoder: Measures how near two texts of a path are; without one only equal words count.
        per_path: Texts per path.
        nearest: Largest cosine between two texts of one path.
        redraws: How often near duplicates are replaced before they are accepted.
        batch: Largest number of texts asked for in one call.
        sample: Keeps independent sets of texts apart.
        threads: How many paths may be under way at once.
    """

    def __init__(
        self,
        llm: LLM,
        encoder: Encoder | None = None,
        *,
        per_path: int = PER_PATH,
        nearest: float = 0.97,
        redraws: int = 2,
        batch: int = 10,
        sample: int = 0,
        threads: int = 1,
    ) -> None:
        self.llm = llm
        self.encoder = encoder
        self.per_path = per_path
        self.nearest = nearest
        self.redraws = redraws
        self.batch = batch
        self.sample = sample
        self.threads = threads

    def run(self, tree: ScenarioTree) -> list[Scenario]:
        """Return `per_path` scenarios for every leaf, in tree order.

        Raises:
            LLMError: When the model fails on one path.
        """
        paths = tree.paths
        found = dict(
            as_finished(
                lambda leaf: self.path(leaf, paths[leaf], self.per_path),
                paths,
                threads=self.threads,
            )
        )
        return [scenario for leaf in paths for scenario in found[leaf]]

    def path(self, leaf: str, path: tuple[str, ...], count: int) -> list[Scenario]:
        """Return `count` scenarios `<leaf>-001`, `<leaf>-002` ... for one path."""
        texts = self._draw(path, count, avoid=())
        for _ in range(self.redraws):
            near = self._near_duplicates(texts)
            if not near:
                break
            kept = [text for index, text in enumerate(texts) if index not in near]
            fresh = self._draw(path, len(near), avoid=tuple(texts))
            texts = kept + fresh
        return [
            Scenario(id=f"{leaf}-{number:03d}", text=text, leaf=leaf, path=path)
            for number, text in enumerate(texts, start=1)
        ]

    def _draw(self, path: tuple[str, ...], count: int, avoid: tuple[str, ...]) -> list[str]:
        texts: list[str] = []
        while len(texts) < count:
            wanted = min(self.batch, count - len(texts))
            prompt = DescribePath(path=path, count=wanted, avoid=(*avoid, *texts))
            answer = ask(self.llm, prompt, sample=self.sample)
            texts += [" ".join(text.split()) for text in answer.texts]
        return texts

    def _near_duplicates(self, texts: list[str]) -> set[int]:
        """Return the positions of texts that are too near an earlier one."""
        if self.encoder is None or len(texts) < 2:
            return set()
        vectors = self.encoder.encode(texts)
        norms = np.sqrt((vectors * vectors).sum(axis=1, keepdims=True))
        unit = vectors / np.maximum(norms, np.float32(1e-12))
        cosines = np.tril(unit @ unit.T, k=-1)
        return {int(row) for row in np.nonzero((cosines > self.nearest).any(axis=1))[0]}


def spread(paths: Mapping[str, tuple[str, ...]], total: int) -> dict[str, int]:
    """Share out `total` texts over the paths as evenly as possible, earlier paths first."""
    base, rest = divmod(total, len(paths))
    return {leaf: base + (index < rest) for index, leaf in enumerate(paths)}


def spread_subset(scenarios: Sequence[Scenario], size: int) -> list[Scenario]:
    """Choose `size` scenarios that cover the paths as evenly as possible.

    The first text of every path comes first, then the second, and so on; of the last level that
    is needed, evenly spaced paths are taken. The order of the scenarios is kept.
    """
    by_leaf: dict[str, list[Scenario]] = {}
    for scenario in scenarios:
        by_leaf.setdefault(scenario.leaf, []).append(scenario)
    chosen: set[str] = set()
    for level in range(max(map(len, by_leaf.values()), default=0)):
        row = [group[level] for group in by_leaf.values() if level < len(group)]
        wanted = min(size - len(chosen), len(row))
        chosen.update(row[index * len(row) // wanted].id for index in range(wanted))
    return [scenario for scenario in scenarios if scenario.id in chosen]
