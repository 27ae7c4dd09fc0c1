"""What a problem is made of: matrix and vector, their files, scales, structure, and what is known of the matrix."""
