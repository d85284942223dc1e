"""Detectors of OOD texts: calibration, anchors, separation, the off-topic guard."""
