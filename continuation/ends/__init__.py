"""How a path ends: at its target, in a singular limit, in its own start, at infinity."""
