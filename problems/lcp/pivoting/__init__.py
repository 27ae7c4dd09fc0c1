"""Complementary pivoting: dictionaries, almost complementary paths, their starts."""
