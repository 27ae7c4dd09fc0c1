"""Hypothesis profiles: `default` is the same every time and quick; HYPOTHESIS_PROFILE=nightly draws anew, at length."""

import os

from hypothesis import settings

settings.register_profile("default", deadline=None, derandomize=True)
settings.register_profile("nightly", deadline=None, max_examples=10_000, print_blob=True)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))
