"""Piecewise linear paths of LCP(q + t d, A), exact between kinks.

Each pair (x_i, w_i) lies on a staircase (`stairs`). Its pieces give linear equations (`basis`), solved at each corner,
which a ratio test finds (`walk`). If several pairs switch, a small LCP gives the rays (`ties`, `corner`).
"""
