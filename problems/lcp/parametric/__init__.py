"""Piecewise linear paths: LCP(q + t d, A) and its kin as t moves, exact between kinks.

Each pair (x_i, w_i) lies on a staircase (`stairs`), on a tread of which one of the two is fixed. On given treads the
solutions are a line, whose equations (`basis`) the treads and what drives the path say: they are factored afresh at
each corner, and nothing is carried on from one to the next. The ratio test tells where the line leaves a tread
(`walk`). There one pair switches, or several do, and the rays that leave are the solutions of a small LCP (`ties`,
`corner`).
"""
