"""Out-of-distribution driving scenarios: from a language model to judged episodes.

Importing the package loads nothing; each name below is imported when it is first used.
"""

from typing import TYPE_CHECKING

from oodscen._lazy import lazily
from oodscen._version import __version__

if TYPE_CHECKING:
    from oodscen.augment import Augmenter
    from oodscen.catalogue import Catalogue
    from oodscen.describe import Describer
    from oodscen.episode import Episode
    from oodscen.errors import OodscenError
    from oodscen.evaluation import evaluate
    from oodscen.grow import TreeGrower
    from oodscen.metrics import Metrics
    from oodscen.prune import Pruner
    from oodscen.redteam import RedTeamer
    from oodscen.registry import make_encoder, make_llm, make_simulator
    from oodscen.scenario import Scenario
    from oodscen.scene import Scene
    from oodscen.simulation import simulate
    from oodscen.study import Study
    from oodscen.tree import ScenarioTree
    from oodscen.verdict import Verdict
else:
    __getattr__, __dir__ = lazily(
        __name__,
        {
            "Augmenter": "augment",
            "Catalogue": "catalogue",
            "Describer": "describe",
            "Episode": "episode",
            "Metrics": "metrics",
            "OodscenError": "errors",
            "Pruner": "prune",
            "RedTeamer": "redteam",
            "Scenario": "scenario",
            "ScenarioTree": "tree",
            "Scene": "scene",
            "Study": "study",
            "TreeGrower": "grow",
            "Verdict": "verdict",
            "evaluate": "evaluation",
            "make_encoder": "registry",
            "make_llm": "registry",
            "make_simulator": "registry",
            "simulate": "simulation",
        },
    )

__all__ = [
    "Augmenter",
    "Catalogue",
    "Describer",
    "Episode",
    "Metrics",
    "OodscenError",
    "Pruner",
    "RedTeamer",
    "Scenario",
    "ScenarioTree",
    "Scene",
    "Study",
    "TreeGrower",
    "Verdict",
    "__version__",
    "evaluate",
    "make_encoder",
    "make_llm",
    "make_simulator",
    "simulate",
]
