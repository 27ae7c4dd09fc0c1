"""Residuals, exact solutions and proofs."""
