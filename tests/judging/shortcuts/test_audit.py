"""The audit of a small study, made without a simulator."""

import numpy as np
import pytest

from oodscen.errors import StudyError
from oodscen.judging._shortcuts.audit import Audit, audit, source
from tests.judging.cases import Case
from tests.needs import needs

pytestmark = needs("sklearn", "cv2")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Rare pictures are bright, and keeping the speed fails in rare scenes alone."""
    import cv2

    folder, case, rng = (
        tmp_path_factory.mktemp("audit"),
        Case(paths=10, per_path=4),
        np.random.default_rng(0),
    )
    for at, one in enumerate(case.episodes):
        grey = 90 if one.is_twin else 160
        picture = (grey + rng.integers(0, 40, (60, 80, 3))).astype(np.uint8)
        assert cv2.imwrite(str(folder / f"{at}.jpg"), picture)
        case.episodes[at] = one.model_copy(
            update={"frames": {"first": "none.jpg", "last": f"{at}.jpg"}}
        )
    return audit(case.episodes, [], case.scenarios, folder), case


def test_every_shortcut_is_scored_between_0_and_1_and_the_best_is_named(made):
    found, case = made
    assert (found.scenes, found.ordinary, found.paths) == (40, {"twin": 40}, 10)
    by_name = {row.name: row for row in found.rows}
    for row in found.rows:
        assert 0 <= row.balanced_accuracy.value <= 1
        assert row.auroc.value is None or 0 <= row.auroc.value <= 1
        assert all(0 <= share <= 1 for share in row.called_by_kind.values())
    assert by_name["keeping the speed fails"].balanced_accuracy.value == 1
    assert by_name["thumbnails, last frame, boosting"].balanced_accuracy.value > 0.95
    assert by_name["colour statistics, last frame, logistic"].auroc.value > 0.95
    for blank in ("number of actors", "map, logistic", "thumbnails, first frame, boosting"):
        assert by_name[blank].balanced_accuracy.value == pytest.approx(0.5, abs=0.01)
    assert found.rows[-1] == by_name["keeping the speed fails"]
    assert by_name[found.best].needs == "pictures"
    assert by_name[found.best].balanced_accuracy.value == max(
        row.balanced_accuracy.value
        for row in found.rows
        if row.method != "pair" and row.needs != "exact places"
    )
    assert set(found.calls) == {episode.scene_id for episode in case.episodes}
    assert found.best in str(found)


def test_an_audit_reads_back_and_holds_for_its_episodes_only(made):
    found, case = made
    assert Audit.parse(found.to_json()) == found
    assert found.made_from == source(reversed(case.episodes)) == source(case.episodes * 2)
    assert found.best_calls(case.episodes) == (found.best, found.calls)
    assert found.best_calls(case.episodes[1:]) is None


def test_one_path_cannot_be_audited(tmp_path):
    case = Case(paths=1)
    with pytest.raises(StudyError):
        audit(case.episodes, [], case.scenarios, tmp_path)
