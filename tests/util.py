"""What tests of paths have in common."""

import pytest

from continuation import CONSERVATIVE, DEFAULT, FAST, SERIES


def by_preset(*presets):
    return pytest.mark.parametrize("preset", presets, ids=lambda preset: preset.name)


every_preset = by_preset(FAST, DEFAULT, CONSERVATIVE)
for_interior_paths = by_preset(DEFAULT, CONSERVATIVE, SERIES)
