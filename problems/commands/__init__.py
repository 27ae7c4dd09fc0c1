"""Commands of the `continuation` program that know about complementarity; found through entry points."""
