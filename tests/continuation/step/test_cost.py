"""What a step costs, in calls of functions: these are the same whatever else the machine does."""

import pytest

from continuation import trace

from ...util import benchmark

steps = benchmark("step.py")


@pytest.mark.parametrize(("name", "most"), [("exponential-cosine-3", 1200), ("example-1", 2700)])
def test_calls_of_functions_a_step(name, most):
    """About a tenth more than measured; 1,628 and 2,807 before overhead was looked for."""
    make, options = steps.PROBLEMS[name]
    homotopy = make()
    counts = trace(homotopy, **options).counts
    assert steps.calls(lambda: trace(homotopy, **options)) <= most * (counts.accepted + counts.rejected)
