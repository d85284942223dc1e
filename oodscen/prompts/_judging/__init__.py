"""Prompts for judged models and for the judge."""
