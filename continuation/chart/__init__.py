"""Speed against accuracy: studies of problems x methods x tolerances, with tables and pictures.

`docs/howto/chart.md` has a study of a homotopy in ten lines.
"""

from continuation.chart.model import Answer, Method, Problem, Truth, reference, traced
from continuation.chart.pictures import Lines, Profile
from continuation.chart.results import WORK, Results, Row, excess, read, write
from continuation.chart.run import run
from continuation.chart.study import END_POINT, Study
from continuation.chart.table import Table, solved, summary

__all__ = [
    "END_POINT", "WORK", "Answer", "Lines", "Method", "Problem", "Profile", "Results", "Row", "Study", "Table",
    "Truth", "excess", "read", "reference", "run", "solved", "summary", "traced", "write",
]  # fmt: skip
