"""Ways to tell rare from ordinary by plain facts, each learnt on other paths."""

from collections.abc import Callable
from typing import Any

import numpy as np

from oodscen.errors import MissingExtra
from oodscen.judging._items import Mask
from oodscen.judging._shortcuts.rules import Guess
from oodscen.statistics._intervals import Floats


class Learners:
    """Learns to tell the rare of some items from the ordinary ones.

    Args:
        is_rare: [n] the items to call out of the ordinary.
        folds: [n] the fold of every item; what is learnt on the others is applied to it.
        seed: Seed of the classifiers.
    """

    def __init__(self, is_rare: Mask, folds: Floats, seed: int) -> None:
        self.is_rare, self._folds, self._seed = is_rare, folds, seed

    def rule(self, name: str, values: Floats) -> Guess:
        """Return the calls of a threshold on one number."""
        return Guess.of(name, values, self.is_rare, self._folds)

    def boosted(self, name: str, columns: Floats) -> Guess:
        """Return the calls of gradient-boosted trees."""
        sklearn = _sklearn()
        return self._cross_validated(
            f"{name}, boosting",
            columns,
            lambda: sklearn.ensemble.HistGradientBoostingClassifier(
                random_state=self._seed, max_leaf_nodes=16, class_weight="balanced"
            ),
        )

    def linear(self, name: str, columns: Floats) -> Guess:
        """Return the calls of a logistic regression on standardised columns."""
        sklearn = _sklearn()
        return self._cross_validated(
            f"{name}, logistic",
            columns,
            lambda: sklearn.pipeline.make_pipeline(
                sklearn.preprocessing.StandardScaler(),
                sklearn.linear_model.LogisticRegression(
                    C=0.01, max_iter=1_000, class_weight="balanced"
                ),
            ),
        )

    def _cross_validated(self, name: str, columns: Floats, make_model: Callable[[], Any]) -> Guess:
        score = np.full(len(columns), 0.5)
        for fold in np.unique(self._folds):
            test = self._folds == fold
            if columns.shape[1] and len(set(self.is_rare[~test].tolist())) == 2:
                model = make_model().fit(columns[~test], self.is_rare[~test])
                score[test] = model.predict_proba(columns[test])[:, 1]
        return Guess(name, score, score > 0.5)


def _sklearn() -> Any:
    try:
        import sklearn.ensemble
        import sklearn.linear_model
        import sklearn.pipeline
        import sklearn.preprocessing
    except ImportError:
        raise MissingExtra("the audit", "audit", "scikit-learn") from None
    return sklearn
