from ._answers import score_answers as score_answers
