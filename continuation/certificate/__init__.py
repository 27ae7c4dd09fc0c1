"""Proofs that traced paths are one path: tubes by Krawczyk's test, linked."""

from continuation.certificate.certifying import certify
from continuation.certificate.proof import Gap, Proof
from continuation.certificate.quadratic import Affine, Quadratic, SupportsQuadratic

__all__ = ["Affine", "Gap", "Proof", "Quadratic", "SupportsQuadratic", "certify"]
