"""Reference methods: Lemke's pivots, modulus iteration, damped min-Newton."""

from problems.lcp.reference.methods import ReferenceResult, lemke, min_newton, modulus

__all__ = ["ReferenceResult", "lemke", "min_newton", "modulus"]
