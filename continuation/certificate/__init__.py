"""Proofs that traced paths are one path: tubes by Krawczyk's test, linked."""

from continuation.certificate.certifying import certify
from continuation.certificate.form import Affine, Quadratic, SupportsQuadratic
from continuation.certificate.proof import Gap, Proof

__all__ = ["Affine", "Gap", "Proof", "Quadratic", "SupportsQuadratic", "certify"]
