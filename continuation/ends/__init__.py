"""Ends of a path: target, singular limit, start, infinity."""
