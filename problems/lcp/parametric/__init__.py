"""Piecewise linear paths of LCP(q + t d, A), exact between kinks.

Each pair (x_i, w_i) lies on a staircase (`stairs`), whose pieces give linear equations (`basis`). A ratio test finds
each corner (`walk`). If several pairs switch, a small LCP gives the rays (`ties`, `corner`).
"""
