"""The data of a problem: matrix and vector, files, scales, structure."""
