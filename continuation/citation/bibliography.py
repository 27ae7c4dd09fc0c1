"""BibTeX entries of the engine's methods."""

from __future__ import annotations

SOFTWARE = """@software{continuation,
  author = {{The continuation developers}},
  title = {continuation: pseudo-arclength continuation with homotopies for the linear complementarity problem},
  year = {2026},
}"""

ALLGOWER_GEORG = """@book{AllgowerGeorg2003,
  author = {Allgower, Eugene L. and Georg, Kurt},
  title = {Introduction to Numerical Continuation Methods},
  publisher = {SIAM},
  year = {2003},
  doi = {10.1137/1.9780898719154},
}"""

BAKER_GRAVES_MORRIS = """@book{BakerGravesMorris1996,
  author = {Baker, George A. and Graves-Morris, Peter},
  title = {Pad{\\'e} Approximants},
  edition = {2},
  publisher = {Cambridge University Press},
  year = {1996},
}"""

COCHELIN = """@article{Cochelin1994,
  author = {Cochelin, Bruno},
  title = {A Path-Following Technique via an Asymptotic-Numerical Method},
  journal = {Computers \\& Structures},
  volume = {53},
  number = {5},
  pages = {1181--1192},
  year = {1994},
}"""

DEUFLHARD = """@book{Deuflhard2004,
  author = {Deuflhard, Peter},
  title = {Newton Methods for Nonlinear Problems: Affine Invariance and Adaptive Algorithms},
  publisher = {Springer},
  year = {2004},
}"""

GOVAERTS = """@book{Govaerts2000,
  author = {Govaerts, Willy J. F.},
  title = {Numerical Methods for Bifurcations of Dynamical Equilibria},
  publisher = {SIAM},
  year = {2000},
}"""

GRIEWANK_WALTHER = """@book{GriewankWalther2008,
  author = {Griewank, Andreas and Walther, Andrea},
  title = {Evaluating Derivatives: Principles and Techniques of Algorithmic Differentiation},
  edition = {2},
  publisher = {SIAM},
  year = {2008},
}"""

KELLER_1977 = """@incollection{Keller1977,
  author = {Keller, Herbert B.},
  title = {Numerical Solution of Bifurcation and Nonlinear Eigenvalue Problems},
  booktitle = {Applications of Bifurcation Theory},
  editor = {Rabinowitz, Paul H.},
  publisher = {Academic Press},
  pages = {359--384},
  year = {1977},
}"""

KELLEY = """@book{Kelley1995,
  author = {Kelley, C. T.},
  title = {Iterative Methods for Linear and Nonlinear Equations},
  publisher = {SIAM},
  year = {1995},
}"""

MORGAN_SOMMESE_WAMPLER = """@article{MorganSommeseWampler1992,
  author = {Morgan, Alexander P. and Sommese, Andrew J. and Wampler, Charles W.},
  title = {A Power Series Method for Computing Singular Solutions to Nonlinear Analytic Systems},
  journal = {Numerische Mathematik},
  volume = {63},
  pages = {391--409},
  year = {1992},
}"""

SQUIRE_TRAPP = """@article{SquireTrapp1998,
  author = {Squire, William and Trapp, George},
  title = {Using Complex Variables to Estimate Derivatives of Real Functions},
  journal = {SIAM Review},
  volume = {40},
  number = {1},
  pages = {110--112},
  year = {1998},
}"""
