"""Homotopies out of residuals that are written for JAX, CasADi or SymPy; each imports its library when it is called."""

from continuation.adapters.casadi import from_casadi
from continuation.adapters.jax import from_jax
from continuation.adapters.sympy import from_sympy

__all__ = ["from_casadi", "from_jax", "from_sympy"]
