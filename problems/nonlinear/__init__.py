"""Homotopies for F(x) = 0, with and without bounds, and examples."""

from problems.nonlinear.brown import BrownAlmostLinear, brown
from problems.nonlinear.complementarity import (
    ComplementaritySolution,
    InteriorHomotopy,
    MixedComplementarity,
    solve_complementarity,
)
from problems.nonlinear.fixed_point import FixedPointHomotopy, fixed_point
from problems.nonlinear.newton import NewtonHomotopy, newton
from problems.nonlinear.normal_map import NormalMap
from problems.nonlinear.obstacle import bratu_under_obstacle

__all__ = [
    "BrownAlmostLinear", "ComplementaritySolution", "FixedPointHomotopy", "InteriorHomotopy",
    "MixedComplementarity", "NewtonHomotopy", "NormalMap", "bratu_under_obstacle", "brown",
    "fixed_point", "newton", "solve_complementarity",
]  # fmt: skip
