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


def test_a_difference_is_noticed():
    expected = {"status": "SOLVED", "end": [1.0], "events": [["fold", 0.5]], "counts": {"solves": [50, 60]}}
    wrong = {"status": "CLOSED", "end": [1.0 + 1e-9], "events": [], "counts": {"solves": 67}}
    assert len(record.differences("x", wrong, expected, exactly=False)) == 4
    assert len(record.differences("x", {**expected, "counts": {"solves": 64}}, expected, exactly=False)) == 0
    assert len(record.differences("x", {**expected, "counts": {"solves": 64}}, expected, exactly=True)) == 1
