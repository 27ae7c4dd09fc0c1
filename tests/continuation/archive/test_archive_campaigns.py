"""The campaigns of the benchmark, small: each work killed twice, each file damaged in each way, and none goes wrong."""

import subprocess
import sys
from pathlib import Path

import pytest

BENCHMARK = Path(__file__).parents[3] / "examples" / "benchmarks" / "archive_benchmark.py"


@pytest.mark.parametrize("campaign", [("--kills", "14"), ("--damage", "36")])
def test_a_small_campaign(campaign):
    command = [sys.executable, str(BENCHMARK), *campaign, "--seed", "5"]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr
    assert campaign[1] in found.stdout
