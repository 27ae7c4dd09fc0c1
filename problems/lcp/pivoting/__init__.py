"""Complementary pivoting: dictionaries, the almost complementary paths through their bases, and where these begin."""
