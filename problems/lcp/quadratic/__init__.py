"""Path proofs for homotopies quadratic in all unknowns and the parameter."""

from problems.lcp.quadratic.engine import ByProducts
from problems.lcp.quadratic.form import Affine, Quadratic

__all__ = ["Affine", "ByProducts", "Quadratic"]
