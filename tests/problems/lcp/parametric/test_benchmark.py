"""The tables of the benchmark run, at their smallest."""

from __future__ import annotations

import pytest

from ....util import benchmark


@pytest.mark.parametrize("name", ["integers", "pieces", "stepping"])
def test_a_table(name, capsys):
    getattr(benchmark("kinks/run.py"), name)(3)
    said = capsys.readouterr().out
    assert {"integers": "ours wrong in 0", "pieces": "; 0 wrong", "stepping": "solve with guess"}[name] in said
