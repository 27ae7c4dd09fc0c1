"""Ends of a path."""
