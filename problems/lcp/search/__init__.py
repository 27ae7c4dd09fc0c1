"""The search for a solution: the order of attempts, paths, restarts, and the outcome."""
