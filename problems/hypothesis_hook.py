"""Hypothesis entry point: strategies for problem types, registered on demand."""

from __future__ import annotations

import sys
from importlib import import_module


def register() -> None:
    """Register strategies if Hypothesis and the classes are both imported.

    Hypothesis calls this through an entry point, `problems.lcp` at import.
    """
    data = sys.modules.get("problems.lcp.data.problem")
    program = sys.modules.get("problems.lcp.data.program")
    strategies = sys.modules.get("hypothesis.strategies")
    if data is None or program is None or strategies is None:
        return

    def register_lazily(of: type, module: str, name: str) -> None:
        strategies.register_type_strategy(of, lambda _: getattr(import_module(module), name)())

    register_lazily(data.LCP, "problems.lcp.strategies", "lcps")
    register_lazily(data.MixedLCP, "problems.lcp.mixed_strategies", "mixed_lcps")
    register_lazily(program.Program, "problems.lcp.mixed_strategies", "programs")
