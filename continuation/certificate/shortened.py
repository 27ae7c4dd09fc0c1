"""Steps short enough for a proof, for `trace(..., certified=True)`."""

from __future__ import annotations

from typing import Any

from continuation.auditing.retrace import Halved
from continuation.certificate.certifying import certify
from continuation.certificate.proof import Proof
from continuation.linear.threads import one_thread
from continuation.step.options import Options
from continuation.step.tracer import Tracer

TRACES = 4
"""Most traces; each halves the steps."""


@one_thread
def provable(homotopy: Any, options: Options) -> tuple[Options, Proof | None]:
    """Options with which the path, or its longest part, is proved, and the proof, if any.

    The recorded trace is the proved one: traces with the same number of threads are equal.
    """
    best: tuple[Options, Proof] | None = None
    tried = options
    for _ in range(TRACES):
        tracer = Tracer(homotopy, **tried)
        for _ in tracer:
            pass
        if len(tracer.path) < 2:
            break
        proof = certify(tracer.path, homotopy)
        if best is None or _missing(proof) < _missing(best[1]):
            best = tried, proof
        if proof.complete:
            break
        tried = {**options, "controller": Halved(tracer.path.arclength)}
    return best if best is not None else (options, None)


def _missing(proof: Proof) -> tuple[float, int]:
    return sum(gap.end - gap.begin for gap in proof.gaps), len(proof.gaps)
