from ._answers import answer_values as answer_values
from ._answers import figures_of as figures_of
from ._publishing import publish as publish
