"""Homotopies that come with the engine: complementarity, nonlinear systems, bifurcation problems, the paper."""
