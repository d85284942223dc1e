from oodscen.stages._redteam.shared_words import shared_word_scores


def test_words_rank_labels():
    labels = ["Fallen tree across the road", "Dog on the road", "Thick fog at night"]
    scores = shared_word_scores("The dogs run towards the ego vehicle.", labels)
    assert max(scores) == scores[1]
    assert shared_word_scores("", labels) == [0.0, 0.0, 0.0]


def test_rare_words_weigh_more_than_common_ones():
    labels = ["Icy bridge", "Road bridge", "Road works", "Closed road"]
    icy, _, works, closed = shared_word_scores("The road is icy.", labels)
    assert icy > 0.5 > works == closed > 0.0
