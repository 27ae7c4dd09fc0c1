"""Evaluates a homotopy: counted, with derivatives from any source."""
