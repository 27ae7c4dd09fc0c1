"""Proofs of paths of homotopies that are quadratic in all unknowns and the parameter, as those of LCPs are."""

from problems.lcp.quadratic.engine import ByProducts
from problems.lcp.quadratic.form import Affine, Quadratic

__all__ = ["Affine", "ByProducts", "Quadratic"]
