"""Homotopies for F(x) = 0 with any F: R^n -> R^n, and Brown's function as the example."""

from problems.nonlinear.brown import BrownAlmostLinear, brown
from problems.nonlinear.differentiable import Differentiable
from problems.nonlinear.fixed_point import FixedPointHomotopy, fixed_point
from problems.nonlinear.newton import NewtonHomotopy, newton

__all__ = [
    "BrownAlmostLinear", "Differentiable", "FixedPointHomotopy", "NewtonHomotopy", "brown", "fixed_point", "newton",
]  # fmt: skip
