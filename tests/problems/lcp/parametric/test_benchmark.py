"""The tables of the benchmark run, at their smallest."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[4] / "examples" / "benchmarks" / "kinks"


@pytest.mark.parametrize("name", ["integers", "pieces", "stepping"])
def test_a_table(name, capsys):
    tables = {table.__name__: table for table in runpy.run_path(str(FOLDER / "run.py"))["TABLES"]}
    tables[name](3)
    said = capsys.readouterr().out
    assert {"integers": "ours wrong in 0", "pieces": "; 0 wrong", "stepping": "solve with guess"}[name] in said
