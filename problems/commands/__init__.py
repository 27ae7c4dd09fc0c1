"""Commands of `continuation` for complementarity problems."""
