"""One registry of homotopies: what it names is what every other place offers."""

import numpy as np
import pytest

from continuation.arguments.plugins import available, describe
from problems import lcp, plugins
from problems.lcp.homotopies.registry import HOMOTOPIES
from problems.paper import EXAMPLES


def test_the_entry_points_are_those_of_the_registry():
    ours = {name: point for name, point in available().items() if "(problems.plugins:" in point.origin}
    assert set(ours) - {"brown-fixed-point"} == set(HOMOTOPIES)
    for name, homotopy in HOMOTOPIES.items():
        factory = ours[name].load()
        assert factory is getattr(plugins, name)
        assert describe(factory).summary == homotopy.sentence
        assert describe(factory).references


@pytest.mark.parametrize("name", HOMOTOPIES)
@pytest.mark.parametrize("refine", [True, False])
def test_each_can_be_made_anywhere_and_solves_its_example(name, refine):
    problem = lcp.LCP([[2.0, 1.0], [0.0, 1.0]], [-1.0, -1.0])
    start = lcp.random_start(problem, np.random.default_rng(0))
    homotopy = HOMOTOPIES[name].at(problem, start, lcp.Structure(problem), refine)
    np.testing.assert_array_equal(homotopy.start()[0][:2], start.x0)
    assert getattr(homotopy, "refine", refine) is refine
    example = EXAMPLES[HOMOTOPIES[name].example - 1]
    assert lcp.solve(example.problem, name, x0=example.x0).solved
    with pytest.raises(ValueError, match=f"homotopy: expected auto or one of .*{name}"):
        lcp.solve(problem, name.upper())
