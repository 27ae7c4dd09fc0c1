"""Homotopies from residuals in JAX, CasADi or SymPy, which are imported on call."""

from continuation.adapters.casadi import from_casadi
from continuation.adapters.jax import from_jax
from continuation.adapters.sympy import from_sympy

__all__ = ["from_casadi", "from_jax", "from_sympy"]
