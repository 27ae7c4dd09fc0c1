"""What the tests of problems with bounds have in common."""

from problems.lcp.active_set import face
from problems.lcp.homotopies import pair_system


def orders(monkeypatch):
    """Where the orders of all matrices that are factored go from here on."""
    found = []

    def spy(module, name):
        real = getattr(module, name)

        def counted(matrix, *rest, **given):
            found.append(getattr(matrix, "matrix", matrix).shape[0])
            return real(matrix, *rest, **given)

        monkeypatch.setattr(module, name, counted)

    for name in ("factor_lu", "factor_cholesky", "factor_superlu", "factor_band"):
        spy(face, name)
    spy(pair_system, "factor_bordered")
    return found
