"""Steps short enough for a proof: what `trace(..., certified=True)` looks for before it records a path."""

from __future__ import annotations

from typing import Any

from continuation.auditing.retrace import Halved
from continuation.certificate.certifying import certify
from continuation.certificate.proof import Proof
from continuation.linear.threads import one_thread
from continuation.step.options import Options
from continuation.step.tracer import Tracer

TRACES = 4
"""Traces at most, each with steps half as long as the one before."""


@one_thread
def provable(homotopy: Any, options: Options) -> tuple[Options, Proof | None]:
    """Options with which the path is proved, or the part of it that is longest, and the proof.

    A trace is the same each time, on as many threads, so that the one that is recorded afterwards is the one that was
    proved.

    Parameters
    ----------
    homotopy : Homotopy
    options : Options
        Those of the trace.

    Returns
    -------
    options : Options
    proof : Proof or None
        None for a path of fewer than two points, of which there is nothing to prove.
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
    """How much of the path is not proved: arclength, and the number of gaps."""
    return sum(gap.end - gap.begin for gap in proof.gaps), len(proof.gaps)
