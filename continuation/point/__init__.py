"""Points and arcs: linearisation, projection, segments."""
