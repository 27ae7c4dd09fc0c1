"""Kinks: where a path of a piecewise smooth map goes from one of its pieces to another."""
