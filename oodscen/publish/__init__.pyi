from ._answers import score_answers as score_answers
from ._publishing import publish as publish
