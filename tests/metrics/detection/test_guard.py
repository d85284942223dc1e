from oodscen import Metrics
from oodscen.baselines import load_controls
from oodscen.metrics._detection.guard import elsewhere
from oodscen.testing._encoder import HashEncoder


def test_it_is_fitted_to_no_text_that_measures_it():
    measured = {
        text.text for half in ("tune", "frozen") for text in load_controls(half, off_topic=True)
    }
    measured |= {text.text for half in ("tune", "frozen") for text in load_controls(half)}
    assert not measured & set(elsewhere())
    assert len(set(elsewhere())) == len(elsewhere()) > 100


def test_words_of_another_subject_score_lower():
    metrics = Metrics(HashEncoder())
    off = metrics.off_topic(["Bake the bread in butter and let the soup cool on the stove."])
    on = metrics.off_topic(["A silver sedan waits at the red light behind a van."])
    assert off.scores[0] < on.scores[0]
    assert not off.calibrated
    everything = metrics.off_topic(["a", "b"], threshold=9.0)
    assert everything.flagged == (0, 1)
    assert everything.share == 1.0
    assert metrics.report(["a"]).off_topic is None
