"""What an argument must be: numbers and flags, names and units of unknowns, names of installed homotopies."""
