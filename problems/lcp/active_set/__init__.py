"""Active sets: the equations of a face, the iteration over faces, and a first guess from coarser problems."""
