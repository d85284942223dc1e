"""The report of a study: one self-contained page that can be mailed, archived and read on a phone."""

from oodscen.report._render import write_report

__all__ = ["write_report"]
