"""Active sets: faces, the iteration over them, first guesses."""
