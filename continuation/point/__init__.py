"""Points and arcs of a path."""
