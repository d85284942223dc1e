"""Verdicts on the runs of other players, by the poses that they wrote."""
