"""What docs/choosing.md states of engines, LCPs and sizes: conditions on the results of a study, by name.

`CLAIMS[study][name]` is a function of the results; `choosing_scenes` has those of scenes.
"""

import math
from statistics import median

from continuation import chart

SERIES = ("Taylor + series range", "Pade + series range")
IN_XY = ("Wang", "Yu", "Xu", "Zhao", "Kojima")
PRESETS = ("DEFAULT", "FAST", "CONSERVATIVE", "SERIES")
REUSE = "bordered, reuse 0.2 (DEFAULT)"


def total(results, method, **where):
    """Factorisations over all runs of a method that succeeded, optionally at one rung or on one problem."""
    return sum(row.work("factorizations") for row in results.of(method=method, **where) if not row.failed)


def ratio(results, a, b, work="factorizations"):
    """Median over the problems and rungs that both solved of a's work over b's."""
    other = {(row.problem, row.rung): row for row in results.of(method=b) if not row.failed}
    pairs = [
        row.work(work) / other[row.problem, row.rung].work(work)
        for row in results.of(method=a)
        if not row.failed and (row.problem, row.rung) in other
    ]
    return median(pairs)


def solved(results, method, **where):
    """Fraction of a method's runs that succeeded."""
    rows = results.of(method=method, **where)
    return sum(not row.failed for row in rows) / len(rows)


def median_excess(results, method):
    """Over the runs that succeeded."""
    far = chart.excess(results, next(iter(results.errors)), "factorizations")
    return median(v for row, v in zip(results.rows, far) if row.method == method and math.isfinite(v))


def seconds(results, method, kind):
    """Median over the problems of a kind that a method solved; None without any."""
    rows = [row for row in results.of(method=method) if row.problem.startswith(kind) and not row.failed]
    return median(row.seconds for row in rows) if rows else None


def other_software_jumps(presets):
    rows = [row for row in presets.of(problem="exponential-cosine, n = 5") if row.outside and row.failed]
    return all(row.method != "PITCON (dense)" for row in rows) and any(row.failure == "wrong end" for row in rows)


def pitcon_is_quick_on_small_dense_systems(presets):
    small, large = (seconds(presets, "PITCON (dense)", kind) for kind in ("exponential-cosine, n = 5", "Bratu 2D"))
    own, whole = (seconds(presets, "DEFAULT", kind) for kind in ("exponential-cosine, n = 5", "Bratu 2D"))
    return small is None or (5.0 * small < own and large > 1.25 * whole)


def tolerance_is_cheap(presets):
    work = [total(presets, "DEFAULT", rung=rung) for rung in sorted({row.rung for row in presets.rows})]
    return max(work) <= 1.15 * min(work)


def default_controller_is_on_the_front(controllers):
    far = chart.excess(controllers, "end_point", "factorizations")
    own = [value for row, value in zip(controllers.rows, far) if row.method == "Allgower-Georg (DEFAULT)"]
    least = min(total(controllers, name) for name in controllers.methods)
    return median(own) == 1.0 and max(own) <= 1.75 and total(controllers, "Allgower-Georg (DEFAULT)") == least


def accuracy_is_the_best(series):
    methods, own = [method for method in series.methods if "Pade" in method], "Pade, accuracy 1e-05 (SERIES)"
    rejected = {m: sum(row.counts.rejected for row in series.of(method=m)) for m in methods}
    least = min(total(series, method) for method in methods)
    return total(series, own) == least and rejected["Pade, accuracy 0.001"] > 50 + rejected[own]


def solve_is_cheaper_than_the_path(paper):
    least = {row.problem: row.work("factorizations") for row in paper.of(method="KKT")}
    cheaper = [row.work("factorizations") < least[row.problem] for row in paper.of(method="solve, auto")]
    return solved(paper, "solve, auto") == 1.0 and sum(cheaper) >= 0.8 * len(cheaper)


def factorizations_do_not_grow(curves):
    counts = {}
    for row in curves.rows:
        counts.setdefault((row.family, row.method), []).append(row.work("factorizations"))
    return all(max(each) < 1.5 * each[0] for each in counts.values())


CLAIMS = {
    "engine-presets": {
        "series_needs_fewest_factorizations": lambda r: (
            all(total(r, "SERIES") < total(r, name) for name in PRESETS[:3])
            and 2.0 < total(r, "DEFAULT") / total(r, "SERIES") < 2.8
        ),
        "other_software_jumps": other_software_jumps,
        "pitcon_is_quick_on_small_dense_systems": pitcon_is_quick_on_small_dense_systems,
        "series_is_slow_on_small_problems": lambda r: ratio(r, "SERIES", "DEFAULT", "seconds") > 1.5,
        "conservative_costs_several_times_default": lambda r: ratio(r, "CONSERVATIVE", "DEFAULT") > 3.0,
        "presets_never_fail": lambda r: all(solved(r, name) == 1.0 for name in PRESETS),
        "fast_saves_little": lambda r: 0.85 < total(r, "FAST") / total(r, "DEFAULT") < 1.0,
        "tolerance_is_cheap": tolerance_is_cheap,
    },
    "engine-predictors": {
        "hermite_is_near_the_best": lambda r: (
            total(r, "Hermite (DEFAULT)")
            <= 1.1 * min(total(r, m) for m in r.methods if m not in SERIES and solved(r, m) == 1.0)
        ),
        "series_and_pade_pay": lambda r: (
            0.5 < total(r, SERIES[0]) / total(r, "Hermite (DEFAULT)") < 0.65
            and total(r, SERIES[1]) < 0.8 * total(r, SERIES[0])
        ),
    },
    "engine-correctors": {
        "reuse_saves_factorizations": lambda r: all(
            ratio(r, name, REUSE) > 2.0 and ratio(r, name, REUSE, "solves") < 1.0
            for name in ("bordered Newton", "Moore-Penrose")
        ),
    },
    "engine-controllers": {
        "default_controller_is_on_the_front": default_controller_is_on_the_front,
        "geometric_is_dear": lambda r: ratio(r, "geometric (the paper's)", "Allgower-Georg (DEFAULT)") > 2.0,
    },
    "engine-metrics": {
        "automatic_metric_is_good": lambda r: (
            solved(r, "automatic (the default)") == 1.0
            and total(r, "automatic (the default)") <= total(r, "Euclidean")
            and total(r, "automatic (the default)") < total(r, "root mean square")
        ),
    },
    "engine-series": {
        "pade_pays": lambda r: all(
            total(r, f"Pade, accuracy {a}") < 0.75 * total(r, f"series, accuracy {b}")
            for a, b in (("1e-05 (SERIES)", "1e-05"), ("1e-07", "1e-07"))
        ),
        "accuracy_is_the_best": accuracy_is_the_best,
    },
    "lcp-paper": {
        "kkt_solves_the_ten_examples": lambda r: (
            solved(r, "KKT") == 1.0 and all(solved(r, name) < 1.0 for name in IN_XY)
        ),
        "solve_is_cheaper_than_the_path": solve_is_cheaper_than_the_path,
        "references_fail_on_some": lambda r: all(
            0.0 < solved(r, name) < 1.0 and median_excess(r, name) < median_excess(r, "KKT")
            for name in ("Lemke", "modulus", "min-Newton")
        ),
        "modulus_makes_many_solves": lambda r: all(
            row.counts.factorizations == 1 and row.counts.solves > 20
            for row in r.of(method="modulus")
            if not row.failed
        ),
    },
    "robustness": {
        "kkt_solves_n_matrices": lambda r: solved(r, "KKT", family="N") == 1.0 and solved(r, "Wang", family="N") == 0.0,
        "zhao_never_arrives": lambda r: solved(r, "Zhao") == 0.0,
        "solve_is_robust_where_theory_says_so": lambda r: all(
            solved(r, "solve, auto", family=family) == 1.0 for family in ("semidefinite", "scaled P", "copositive")
        ),
        "other_paths_fail_on_indefinite": lambda r: (
            solved(r, "KKT", family="indefinite") == 1.0
            and all(solved(r, name, family="indefinite") < 1.0 for name in IN_XY)
        ),
    },
    "scaling-lcp": {
        "wang_series_saves": lambda r: (
            solved(r, "Wang") == solved(r, "Wang, series") == 1.0 and ratio(r, "Wang, series", "Wang") <= 0.85
        ),
        "kkt_fails_on_scaled_p": lambda r: all(
            row.failure == "budget" for row in r.of(family="scaled P", method="KKT") if row.n >= 100
        ),
    },
    "scaling-curves": {"factorizations_do_not_grow": factorizations_do_not_grow},
}
