"""Settings of the whole suite: no network, no chance, no clock."""

import os

from hypothesis import settings

os.environ["OODSCEN_OFFLINE"] = "1"
os.environ.setdefault("HF_HUB_OFFLINE", "1")

settings.register_profile("suite", derandomize=True, deadline=None, database=None)
settings.register_profile("thorough", max_examples=5_000, deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "suite"))
