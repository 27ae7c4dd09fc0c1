"""Proofs: residuals in twice the working precision, exact solutions, Farkas vectors, strictly feasible points."""
