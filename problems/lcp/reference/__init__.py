"""Reference methods for comparison: Lemke's pivots, the modulus iteration, a damped min-Newton."""

from problems.lcp.reference.methods import ReferenceResult, lemke, min_newton, modulus

__all__ = ["ReferenceResult", "lemke", "min_newton", "modulus"]
