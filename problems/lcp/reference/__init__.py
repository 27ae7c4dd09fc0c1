"""Reference methods for comparison: Lemke's pivots, the modulus iteration, a damped min-Newton."""

from problems.lcp.reference.lemke import lemke
from problems.lcp.reference.modulus import modulus
from problems.lcp.reference.newton import min_newton
from problems.lcp.reference.result import ReferenceResult

__all__ = ["ReferenceResult", "lemke", "min_newton", "modulus"]
