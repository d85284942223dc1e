from ._charts.plots import distributions as distributions
from ._charts.plots import embedding_map as embedding_map
from ._charts.plots import size_curve as size_curve
from ._sections import PARTS as PARTS
