"""The search for a solution of an LCP."""
