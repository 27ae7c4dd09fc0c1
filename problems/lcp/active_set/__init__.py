"""Active sets: faces, iteration, guesses."""
