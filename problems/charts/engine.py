"""Compare the engine's presets, predictors, correctors, controllers, series and metrics."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import continuation
from continuation.chart import END_POINT, Lines, Problem, Study, traced
from continuation.chart.study import Size
from continuation.controllers import AllgowerGeorg, Bounds, Fixed, SeriesRange
from continuation.correctors import BorderedNewton, MoorePenrose, NaturalParameter
from continuation.metric import Automatic, Euclidean, Relative, RootMeanSquare
from continuation.predictors import Hermite, Tangent, Taylor
from problems.charts import rivals
from problems.charts.subjects import bratu, bratu_square, cosine, freudenstein

Parts = dict[str, dict[str, Any]]
PARTS: dict[str, tuple[str, Parts]] = {
    "presets": ("presets", {
        preset.name: {"preset": preset}
        for preset in (continuation.DEFAULT, continuation.FAST, continuation.CONSERVATIVE, continuation.SERIES)
    }),
    "predictors": ("predictors, the other parts as in DEFAULT", {
        "Hermite (DEFAULT)": {"predictor": Hermite()},
        "tangent": {"predictor": Tangent()},
        "Taylor + series range": {"predictor": Taylor(), "controller": SeriesRange()},
        "Pade + series range": {"predictor": Taylor(rational=True), "controller": SeriesRange()},
    }),
    "correctors": ("correctors, the other parts as in DEFAULT", {
        "bordered, reuse 0.2 (DEFAULT)": {"corrector": BorderedNewton(0.2)},
        "bordered, reuse 0.5": {"corrector": BorderedNewton(0.5)},
        "bordered Newton": {"corrector": BorderedNewton(0.0)},
        "Moore-Penrose": {"corrector": MoorePenrose()},
        "natural parameter": {"corrector": NaturalParameter()},
    }),
    "series": ("accuracy and kind of the series, the other parts as in SERIES", {
        f"{kind}, accuracy {accuracy:g}{' (SERIES)' if rational and accuracy == 1e-5 else ''}": {
            "preset": continuation.SERIES,
            "predictor": Taylor(accuracy=accuracy, rational=rational),
        }
        for kind, rational in (("Pade", True), ("series", False))
        for accuracy in (1e-3, 1e-5, 1e-7)
    }),
    "metrics": ("metrics, the parts as in DEFAULT", {
        "automatic (the default)": {"metric": Automatic()},
        "Euclidean": {"metric": Euclidean()},
        "root mean square": {"metric": RootMeanSquare()},
        "relative": {"metric": Relative(floor=1e-3)},
    }),
    "controllers": ("step controllers, the other parts as in DEFAULT", {
        "Allgower-Georg (DEFAULT)": {"controller": continuation.DEFAULT.controller},
        "Allgower-Georg, own values": {"controller": AllgowerGeorg()},
        "fixed, 0.1": {"controller": Fixed()},
        "geometric (the paper's)": {"controller": Fixed(Bounds(1e-6, initial=1.0), max_angle=math.inf)},
    }),
}  # fmt: skip
"""Title and methods of a study by name."""

COUNTED = ("factorizations", "solves", "residuals")


def studies(size: Size, compare: bool) -> Sequence[Study]:
    """One study per kind of part."""
    problems = _problems(size)
    rungs = {"smoke": (1e-6,), "moderate": (1e-3, 1e-6, 1e-9), "full": (1e-3, 1e-5, 1e-7, 1e-9, 1e-11)}[size]
    found: list[Study] = []
    for name, (title, parts) in PARTS.items():
        methods = [traced(label, budget=continuation.Budget(steps=3000), **options) for label, options in parts.items()]
        whole = name == "presets"
        square = [bratu_square({"smoke": 5, "moderate": 20, "full": 40}[size])] if whole else []
        shown = [one.name for one in (*square, problems[-1])]
        found.append(
            Study(
                name=f"engine-{name}",
                title=f"Tolerance against work: {title}",
                problems=[*problems, *square],
                methods=[*methods, *rivals.curve_followers(compare)] if whole else methods,
                # A series hardly depends on the tolerance.
                ladder=rungs[:: 2 if name == "series" else 1],
                errors=END_POINT,
                work=(*COUNTED, "seconds") if whole else COUNTED,
                figures=[Lines("end_point", ("seconds", "factorizations"), shown)] if whole else [],
                repeats={"smoke": 0, "moderate": 1, "full": 3}[size] if whole else 0,
            )
        )
    return found


def _problems(size: Size) -> list[Problem]:
    if size == "smoke":
        return [freudenstein(), cosine(3)]
    bratu_n = 100 if size == "moderate" else 1000
    return [freudenstein(), bratu(bratu_n), *(cosine(n) for n in ((3, 5) if size == "moderate" else (3, 5, 8)))]
