"""Piecewise linear paths: LCP(q + t d, A) and its kin as t moves, exact between kinks.

Each pair (x_i, w_i) lies on a staircase (`stairs`), on a tread of which one of the two is fixed. On given treads the
solutions are a line; the ratio test tells where it leaves one (`walk`). There one pair switches, a pivot of the basis
(`basis`), or several do, and the rays that leave are the solutions of a small LCP (`ties`, `corner`).
"""
