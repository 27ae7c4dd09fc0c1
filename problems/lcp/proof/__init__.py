"""Proofs: accurate residuals, exact solutions, Farkas vectors, strictly feasible points."""
