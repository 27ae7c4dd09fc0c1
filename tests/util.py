"""What tests of several rooms have in common."""

import pytest

from continuation import CONSERVATIVE, DEFAULT, FAST, SERIES
from continuation.archive import ArchiveError


def by_preset(*presets):
    return pytest.mark.parametrize("preset", presets, ids=lambda preset: preset.name)


every_preset = by_preset(FAST, DEFAULT, CONSERVATIVE)
for_interior_paths = by_preset(DEFAULT, CONSERVATIVE, SERIES)


def refused(argument, call):
    """The call is refused with a line about the argument, or the file of that name; warnings are errors here."""
    with pytest.raises((TypeError, ValueError, LookupError, ArchiveError)) as caught:
        call()
    text = str(caught.value.args[0] if isinstance(caught.value, KeyError) else caught.value)
    assert "\n" not in text
    assert text.startswith(f"{argument}: "), text
    assert len(text) < 400
