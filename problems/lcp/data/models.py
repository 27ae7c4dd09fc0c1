"""Programs from QPS, MPS and LP files, read by HiGHS."""

from __future__ import annotations

import shutil
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import scipy.sparse as sp

from problems.lcp.data.program import Program, from_qp

MODEL_FORMATS = (".qps", ".mps", ".lp")


def read_model(file: str) -> Program:
    """Read a program; maximisation changes signs.

    Raises `ImportError` without highspy, `ValueError` if the file is unreadable or has integer variables.
    """
    try:
        import highspy
    except ImportError:
        raise ImportError("expected highspy for this format, found none; pip install pseudoarclength[mps]") from None
    solver = highspy.Highs()
    solver.setOptionValue("output_flag", False)
    with TemporaryDirectory() as folder:
        # HiGHS does not know the extension .qps.
        known = file
        if file.lower().endswith(".qps"):
            known = str(shutil.copy(file, Path(folder) / "model.mps"))
        read = solver.readModel(known)
    if read == highspy.HighsStatus.kError:
        raise ValueError("expected a model that HiGHS reads, found another")
    model = solver.getModel()
    lp = model.lp_
    if any(kind != highspy.HighsVarType.kContinuous for kind in lp.integrality_):
        raise ValueError("expected continuous variables, found integer ones")
    sign = -1.0 if lp.sense_ == highspy.ObjSense.kMaximize else 1.0
    n, m = lp.num_col_, lp.num_row_
    rows = _matrix(lp.a_matrix_, (m, n), by_rows=lp.a_matrix_.format_ == highspy.MatrixFormat.kRowwise)
    hessian = model.hessian_
    P = sp.csr_array((n, n))
    if hessian.dim_:
        triangle = _matrix(hessian, (n, n), by_rows=False)
        P = sp.csr_array(triangle + triangle.T - sp.diags_array(triangle.diagonal()))
        if hessian.format_ == highspy.HessianFormat.kSquare:
            P = triangle
    bounds = {"lower": lp.col_lower_, "upper": lp.col_upper_}
    ends = {"h": lp.row_upper_, "rows_lower": lp.row_lower_} if m else {}
    return from_qp(
        sign * P, sign * np.array(lp.col_cost_), rows if m else None,
        **{name: np.array(value, dtype=float) for name, value in (bounds | ends).items()},
    )  # fmt: skip


def _matrix(stored: Any, shape: tuple[int, int], by_rows: bool) -> Any:
    parts = np.array(stored.value_), np.array(stored.index_), np.array(stored.start_)
    return sp.csr_array((sp.csr_array if by_rows else sp.csc_array)(parts, shape=shape))
