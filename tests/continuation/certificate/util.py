"""Paths with their proofs."""

from continuation import certify, trace


def proved(homotopy, **options):
    """A path and its proof, which is complete."""
    path = trace(homotopy, **options)
    proof = certify(path, homotopy)
    assert proof.complete, str(proof)
    return path, proof
