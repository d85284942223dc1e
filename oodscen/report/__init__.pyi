from ._charts.plots import plot as plot
