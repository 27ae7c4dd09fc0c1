"""Hypothesis entry point: strategies for problem types, registered on demand."""

from __future__ import annotations

import sys


def register() -> None:
    """Register strategies if Hypothesis and the classes are both imported.

    Hypothesis calls this through an entry point, `problems.lcp` at import.
    """
    data = sys.modules.get("problems.lcp.data.problem")
    program = sys.modules.get("problems.lcp.data.program")
    strategies = sys.modules.get("hypothesis.strategies")
    if data is None or program is None or strategies is None:
        return

    def problems_of_any_class(_: type) -> object:
        from problems.lcp.strategies import lcps

        return lcps()

    def problems_with_bounds(_: type) -> object:
        from problems.lcp.mixed_strategies import mixed_lcps

        return mixed_lcps()

    def quadratic_programs(_: type) -> object:
        from problems.lcp.mixed_strategies import programs

        return programs()

    strategies.register_type_strategy(data.LCP, problems_of_any_class)
    strategies.register_type_strategy(data.MixedLCP, problems_with_bounds)
    strategies.register_type_strategy(program.Program, quadratic_programs)
