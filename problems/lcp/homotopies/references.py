"""BibTeX entries of the homotopies."""

from __future__ import annotations

DUTTA_DAS_JANA = """@misc{DuttaDasJana,
  author = {Dutta, A. and Das, A. K. and Jana, R.},
  title = {Bounded Homotopy Path Approach to Find the Solution of Linear Complementarity Problems},
}"""

YU = """@misc{Yu2006,
  author = {Yu and others},
  year = {2006},
  note = {homotopy for positive semidefinite matrices, as quoted by Dutta, Das and Jana},
}"""

ZHAO = """@misc{Zhao2010,
  author = {Zhao and others},
  year = {2010},
  note = {homotopy for N-matrices, as quoted by Dutta, Das and Jana},
}"""

XU = """@misc{Xu,
  author = {Xu and others},
  note = {homotopy for P-matrices, as quoted by Dutta, Das and Jana},
}"""

WANG = """@misc{Wang2010,
  author = {Wang and others},
  year = {2010},
  note = {homotopy for P*-matrices, as quoted by Dutta, Das and Jana; IEEE Xplore document 5609642},
}"""

KOJIMA_MEGIDDO_MIZUNO = """@article{KojimaMegiddoMizuno1993,
  author = {Kojima, Masakazu and Megiddo, Nimrod and Mizuno, Shinji},
  title = {A General Framework of Continuation Methods for Complementarity Problems},
  journal = {Mathematics of Operations Research},
  volume = {18},
  number = {4},
  pages = {945--963},
  year = {1993},
  doi = {10.1287/moor.18.4.945},
}"""
