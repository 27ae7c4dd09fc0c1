"""A point of the path and the arc between two: linearization, projection onto the path, segments."""
