"""Complementary pivoting."""
