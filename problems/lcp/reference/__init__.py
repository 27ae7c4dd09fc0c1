"""Reference methods: Lemke's pivots, modulus iteration, damped min-Newton."""

from problems.lcp.reference.methods import lemke, min_newton, modulus

__all__ = ["lemke", "min_newton", "modulus"]
