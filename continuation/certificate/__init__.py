"""Proofs that a traced path is one curve, in interval arithmetic, on the cubics between its points.

Krawczyk's test (`certificate.krawczyk`) on a cell gives a tube that holds exactly one smooth curve of zeros. The test
on a cell of length zero links tubes, proves points and events, and joins the arcs of a kinked path. Signs along the
curve count turning points and kinks. The search for cells and radii is heuristic; `verify` decides what they prove.
"""

from continuation.certificate.certifying import certify
from continuation.certificate.engine import Engine, Judged, SupportsProofEngine
from continuation.certificate.proof import Gap, Proof

__all__ = ["Engine", "Gap", "Judged", "Proof", "SupportsProofEngine", "certify"]
