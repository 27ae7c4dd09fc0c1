"""Proofs that traced paths are one path: one inequality, in intervals, on the cubics between a path's points.

In the chart c . (u - p(s)) = 0 across a cubic p let G(s, u) = (H(u), c . (u - p(s))), and Y any matrix. Where

    |Y G(s, p(s))| + |I - Y G'(p(s) + [-r, r])| r < r        for all s of a cell,

the tube p(s) + [-r, r] holds one smooth curve of zeros of H (Krawczyk). The same inequality on a cell of no length
links two tubes at a node, puts the curve next to each stored point and event, and joins the arcs of a kinked path. What
is left is signs along the curve: of the parameter's component of the tangent, whose zeros are turning points, and of
switches. Cells and radii are searched for by any means; `verify` says what of them is a proof.
"""

from continuation.certificate.certifying import certify
from continuation.certificate.engine import Engine, Judged, SupportsProofEngine
from continuation.certificate.proof import Gap, Proof

__all__ = ["Engine", "Gap", "Judged", "Proof", "SupportsProofEngine", "certify"]
