"""Arithmetic with identical bits on every machine, and compiled kernels."""
