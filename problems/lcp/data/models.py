"""Programs from QPS, MPS and LP files, read by HiGHS."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import scipy.sparse as sp

from continuation.archive.hdf5 import Allowance


def read_model(file: str, allowance: Allowance) -> Mapping[str, Any]:
    """Read the arguments of `from_qp`; maximisation changes signs.

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
    lp, hessian = model.lp_, model.hessian_
    if any(kind != highspy.HighsVarType.kContinuous for kind in lp.integrality_):
        raise ValueError("expected continuous variables, found integer ones")
    sign = -1.0 if lp.sense_ == highspy.ObjSense.kMaximize else 1.0
    given = {"c": [sign * cost for cost in lp.col_cost_], "lower": lp.col_lower_, "upper": lp.col_upper_}
    if hessian.dim_:
        triangle = _by_columns(hessian, hessian.dim_)
        given["P"] = sign * (triangle + triangle.T - sp.diags_array(triangle.diagonal()))
    if lp.num_row_:
        given |= {"G": _by_columns(lp.a_matrix_, lp.num_row_), "h": lp.row_upper_, "rows_lower": lp.row_lower_}
    return given


def _by_columns(stored: Any, rows: int) -> Any:
    return sp.csc_array((stored.value_, stored.index_, stored.start_), shape=(rows, len(stored.start_) - 1))
