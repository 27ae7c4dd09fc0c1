"""Hypothesis profiles: `default` is the same every time and quick; HYPOTHESIS_PROFILE=nightly draws anew, at length.

Neither fails where the machine is slow: no clock decides a test.
"""

import os

from hypothesis import HealthCheck, settings

slow = [HealthCheck.too_slow]
settings.register_profile("default", deadline=None, max_examples=60, derandomize=True, suppress_health_check=slow)
settings.register_profile("nightly", deadline=None, max_examples=10_000, print_blob=True, suppress_health_check=slow)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "default"))
