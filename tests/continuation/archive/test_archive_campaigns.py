"""The campaigns of the benchmark, small: each work killed twice, each file damaged in each way, and none goes wrong."""

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[3] / "examples" / "benchmarks"


@pytest.mark.parametrize("campaign", [("archive_kills.py", "3"), ("archive_damage.py", "36")])
def test_a_small_campaign(campaign):
    command = [sys.executable, str(BENCHMARKS / campaign[0]), campaign[1], "5"]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr
    assert f"0 of {campaign[1]} wrong" in found.stdout
