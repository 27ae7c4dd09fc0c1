"""Kinks, where a path of a piecewise smooth map changes pieces."""
