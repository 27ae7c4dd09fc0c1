"""Proofs that a traced path is one curve, in interval arithmetic.

Krawczyk's test gives tubes around the cubics between points, each with exactly one curve of zeros. Tests at single
parameters link the tubes, prove points and events, and join the arcs of kinked paths. Signs along the curve count
turning points and kinks.
"""

from continuation.certificate.certifying import certify
from continuation.certificate.engine import Engine, Judged, SupportsProofEngine
from continuation.certificate.proof import Gap, Proof

__all__ = ["Engine", "Gap", "Judged", "Proof", "SupportsProofEngine", "certify"]
