"""Proofs that traced paths are one path: tubes by Krawczyk's test, linked."""

from continuation.certificate.certifying import certify
from continuation.certificate.engine import Engine, Judged, SupportsProofEngine
from continuation.certificate.proof import Gap, Proof

__all__ = ["Engine", "Gap", "Judged", "Proof", "SupportsProofEngine", "certify"]
