"""Detectors of OOD texts: calibration, anchors, the off-topic guard."""
