"""The third-party package Gymnasium, or an error that says how to install it."""

from oodscen.errors import MissingExtra

try:
    import gymnasium
except ImportError:
    raise MissingExtra("oodscen.gymnasium", "gymnasium", "gymnasium") from None

__all__ = ["gymnasium"]
