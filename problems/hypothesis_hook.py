"""Hypothesis's entry point: `st.from_type(LCP)` gives problems; a session without `problems.lcp` pays nothing."""

from __future__ import annotations

import sys


def register() -> None:
    """Register the strategy of LCP if both Hypothesis and the problem class are imported; otherwise do nothing.

    Called from two places, so that the order of the two imports does not matter: Hypothesis calls it through the entry
    point group `hypothesis` when it is imported, and `problems.lcp` calls it when that is imported.
    """
    problem = sys.modules.get("problems.lcp.data.problem")
    strategies = sys.modules.get("hypothesis.strategies")
    if problem is None or strategies is None:
        return

    def problems_of_any_class(_: type) -> object:
        from problems.lcp.strategies import lcps

        return lcps()

    strategies.register_type_strategy(problem.LCP, problems_of_any_class)
