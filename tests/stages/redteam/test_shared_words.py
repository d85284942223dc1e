from oodscen.stages._redteam.shared_words import by_words


def test_words_rank_labels():
    labels = ["Fallen tree across the road", "Dog on the road", "Thick fog at night"]
    scores = by_words("The dogs run towards the ego vehicle.", labels)
    assert max(scores) == scores[1]
    assert by_words("", labels) == [0.0, 0.0, 0.0]


def test_rare_words_weigh_more_than_common_ones():
    labels = ["Icy bridge", "Road bridge", "Road works", "Closed road"]
    icy, _, works, closed = by_words("The road is icy.", labels)
    assert icy > 0.5 > works == closed > 0.0
