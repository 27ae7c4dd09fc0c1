"""The engine and the solver do what they did: see `record.py`, which wrote down status, events, ends and counts."""

from pathlib import Path

import pytest

from ..util import load

record = load(Path(__file__).with_name("record.py"))


@pytest.mark.parametrize("preset", record.PRESETS, ids=lambda preset: preset.name)
def test_paths_are_as_recorded(preset):
    assert record.compare({f"{name} {preset.name}" for name in record.paths()}) == []


def test_answers_are_as_recorded():
    assert record.compare({f"lcp {k}" for k in range(record.PROBLEMS)}) == []
