"""What a problem is made of: matrix and vector, their files, scales, structure, and what is known of the matrix.

A problem is validated once, where it is made. A file is read by the reader of its format; a foreign one in a child
process with limits, so that what a damaged file does to a compiled reader ends the child alone, and its counts are
compared with what it holds.
"""
