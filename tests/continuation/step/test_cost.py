"""What a step costs, in calls of functions: these are the same whatever else the machine does."""

import runpy
from pathlib import Path

import pytest

from continuation import trace

BENCHMARK = runpy.run_path(str(Path(__file__).parents[3] / "examples" / "benchmarks" / "size" / "step.py"))


@pytest.mark.parametrize(("name", "most"), [("exponential-cosine-3", 1250), ("example-1", 2450)])
def test_calls_of_functions_a_step(name, most):
    """About a tenth more than measured (1,138 and 2,236); 1,628 and 2,807 before overhead was looked for."""
    homotopy, options = BENCHMARK["problem"](name)
    counts = trace(homotopy, **options).counts
    calls = BENCHMARK["calls"](lambda: trace(homotopy, **options))
    assert calls <= most * (counts.accepted + counts.rejected)


def test_what_the_benchmark_measures():
    found = BENCHMARK["measured"]("circle")
    assert found["steps"] == 24
    assert found["factorizations"] == 27
    assert found["calls"] > 24 * 100
