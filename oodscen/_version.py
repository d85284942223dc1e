"""The version of oodscen."""

__version__ = "0.1.0"
