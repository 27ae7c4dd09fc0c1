"""BibTeX entries of bifurcation and nonlinear problems."""

from __future__ import annotations

BRATU = """@article{Bratu1914,
  author = {Bratu, G.},
  title = {Sur les {\\'e}quations int{\\'e}grales non lin{\\'e}aires},
  journal = {Bulletin de la Soci{\\'e}t{\\'e} Math{\\'e}matique de France},
  volume = {42},
  pages = {113--142},
  year = {1914},
}"""

BROWN = """@article{Brown1969,
  author = {Brown, Kenneth M.},
  title = {A Quadratically Convergent {N}ewton-Like Method Based upon {G}aussian Elimination},
  journal = {SIAM Journal on Numerical Analysis},
  volume = {6},
  number = {4},
  pages = {560--569},
  year = {1969},
}"""

CHOW_MALLET_PARET_YORKE = """@article{ChowMalletParetYorke1978,
  author = {Chow, Shui-Nee and Mallet-Paret, John and Yorke, James A.},
  title = {Finding Zeroes of Maps: Homotopy Methods That Are Constructive with Probability One},
  journal = {Mathematics of Computation},
  volume = {32},
  number = {143},
  pages = {887--899},
  year = {1978},
}"""

DE_BOOR_SWARTZ = """@article{deBoorSwartz1973,
  author = {de Boor, Carl and Swartz, Blair},
  title = {Collocation at {G}aussian Points},
  journal = {SIAM Journal on Numerical Analysis},
  volume = {10},
  number = {4},
  pages = {582--606},
  year = {1973},
}"""

FREUDENSTEIN_ROTH = """@article{FreudensteinRoth1963,
  author = {Freudenstein, Ferdinand and Roth, Bernard},
  title = {Numerical Solution of Systems of Nonlinear Equations},
  journal = {Journal of the ACM},
  volume = {10},
  number = {4},
  pages = {550--556},
  year = {1963},
}"""

GOLUBITSKY_SCHAEFFER = """@book{GolubitskySchaeffer1985,
  author = {Golubitsky, Martin and Schaeffer, David G.},
  title = {Singularities and Groups in Bifurcation Theory, Volume I},
  publisher = {Springer},
  year = {1985},
}"""

KELLER_1978 = """@incollection{Keller1978,
  author = {Keller, Herbert B.},
  title = {Global Homotopies and {N}ewton Methods},
  booktitle = {Recent Advances in Numerical Analysis},
  editor = {de Boor, Carl and Golub, Gene H.},
  publisher = {Academic Press},
  pages = {73--94},
  year = {1978},
}"""

MELHEM_RHEINBOLDT = """@article{MelhemRheinboldt1982,
  author = {Melhem, Rami G. and Rheinboldt, Werner C.},
  title = {A Comparison of Methods for Determining Turning Points of Nonlinear Equations},
  journal = {Computing},
  volume = {29},
  pages = {201--226},
  year = {1982},
}"""

RHEINBOLDT_BURKARDT = """@article{RheinboldtBurkardt1983,
  author = {Rheinboldt, Werner C. and Burkardt, John V.},
  title = {A Locally Parameterized Continuation Process},
  journal = {ACM Transactions on Mathematical Software},
  volume = {9},
  number = {2},
  pages = {215--235},
  year = {1983},
}"""

ROBINSON = """@article{Robinson1992,
  author  = {Robinson, Stephen M.},
  title   = {Normal maps induced by linear transformations},
  journal = {Mathematics of Operations Research},
  volume  = {17},
  number  = {3},
  pages   = {691--714},
  year    = {1992},
}"""

WATSON = """@article{Watson1979,
  author = {Watson, Layne T.},
  title = {A Globally Convergent Algorithm for Computing Fixed Points of {$C^2$} Maps},
  journal = {Applied Mathematics and Computation},
  volume = {5},
  number = {4},
  pages = {297--311},
  year = {1979},
}"""

WRIGHT = """@article{Wright1992,
  author = {Wright, Stephen J.},
  title = {Stable Parallel Algorithms for Two-Point Boundary Value Problems},
  journal = {SIAM Journal on Scientific and Statistical Computing},
  volume = {13},
  number = {3},
  pages = {742--764},
  year = {1992},
}"""
