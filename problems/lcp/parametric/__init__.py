"""Piecewise linear paths: LCP(q + t d, A) and its kin as t moves, exact between kinks."""
