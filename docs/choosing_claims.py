"""What docs/choosing.md states, as tests by the names that the page gives them; parameters are the studies' names."""

import math
from statistics import median

from continuation import chart

SERIES = ("Taylor + series range", "Pade + series range")
IN_XY = ("Wang", "Yu", "Xu", "Zhao", "Kojima")


class Charts:
    """The stored results of a folder by study, read when asked for."""

    def __init__(self, folder):
        self.folder, self._read = folder, {}

    def __getitem__(self, study):
        if study not in self._read:
            self._read[study] = chart.read(self.folder / f"{study}.json")
        return self._read[study]


def total(results, method, work="factorizations", **where):
    """Work over all runs of a method that succeeded, optionally at one rung or on one problem."""
    rows = [row for row in results.of(method=method) if all(getattr(row, k) == v for k, v in where.items())]
    return sum(row.work(work) for row in rows if not row.failed)


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
    rows = [row for row in results.of(method=method) if all(getattr(row, k) == v for k, v in where.items())]
    return sum(not row.failed for row in rows) / len(rows)


def median_excess(results, method, work="factorizations"):
    """Over the runs that succeeded."""
    far = chart.excess(results, next(iter(results.errors)), work)
    return median(v for row, v in zip(results.rows, far) if row.method == method and math.isfinite(v))


# -- presets -------------------------------------------------------------------------------------------------------


PRESETS = ("DEFAULT", "FAST", "CONSERVATIVE", "SERIES")


def series_needs_fewest_factorizations(engine_presets):
    return all(total(engine_presets, "SERIES") < total(engine_presets, name) for name in PRESETS[:3]) and (
        2.0 < total(engine_presets, "DEFAULT") / total(engine_presets, "SERIES") < 2.8
    )


def other_software_jumps(engine_presets):
    rows = [row for row in engine_presets.of(problem="exponential-cosine, n = 5") if row.outside and row.failed]
    return all(row.method != "PITCON (dense)" for row in rows) and any(row.failure == "wrong end" for row in rows)


def pitcon_is_quick_on_small_dense_systems(engine_presets):

    def seconds(method, kind):
        rows = [row for row in engine_presets.of(method=method) if row.problem.startswith(kind) and not row.failed]
        return median(row.seconds for row in rows) if rows else None

    small, large = (seconds("PITCON (dense)", kind) for kind in ("exponential-cosine, n = 5", "Bratu 2D"))
    return small is None or (
        5.0 * small < seconds("DEFAULT", "exponential-cosine, n = 5") and large > 1.25 * seconds("DEFAULT", "Bratu 2D")
    )


def series_is_slow_on_small_problems(engine_presets):
    return ratio(engine_presets, "SERIES", "DEFAULT", "seconds") > 1.5


def conservative_costs_several_times_default(engine_presets):
    return ratio(engine_presets, "CONSERVATIVE", "DEFAULT") > 3.0


def presets_never_fail(engine_presets):
    return all(solved(engine_presets, name) == 1.0 for name in PRESETS)


def fast_saves_little(engine_presets):
    return 0.85 < total(engine_presets, "FAST") / total(engine_presets, "DEFAULT") < 1.0


def tolerance_is_cheap(engine_presets):
    work = [total(engine_presets, "DEFAULT", rung=rung) for rung in sorted({row.rung for row in engine_presets.rows})]
    return max(work) <= 1.15 * min(work)


# -- predictors ----------------------------------------------------------------------------------------------------


def hermite_is_near_the_best(engine_predictors):
    others = [m for m in engine_predictors.methods if m not in SERIES and solved(engine_predictors, m) == 1.0]
    return total(engine_predictors, "Hermite (DEFAULT)") <= 1.1 * min(total(engine_predictors, m) for m in others)


def series_and_pade_pay(engine_predictors):
    series, pade = SERIES
    return (
        0.5 < total(engine_predictors, series) / total(engine_predictors, "Hermite (DEFAULT)") < 0.65
        and total(engine_predictors, pade) < 0.8 * total(engine_predictors, series)
    )  # fmt: skip


def series_has_the_best_dense_output(engine_steps):
    rungs = sorted({row.rung for row in engine_steps.rows})

    def error(problem, method, rung):
        (row,) = (r for r in engine_steps.of(problem=problem, method=method) if r.rung == rung)
        return row.errors["curve_distance"]

    return all(
        100.0 * error(p, SERIES[0], rungs[-1]) < error(p, "Hermite (DEFAULT)", rungs[0]) for p in engine_steps.problems
    )


# -- correctors and controllers ------------------------------------------------------------------------------------

DEFAULT_CORRECTOR = "bordered, reuse 0.2 (DEFAULT)"


def reuse_saves_factorizations(engine_correctors):
    return all(
        ratio(engine_correctors, name, DEFAULT_CORRECTOR) > 2.0
        and ratio(engine_correctors, name, DEFAULT_CORRECTOR, "solves") < 1.0
        for name in ("bordered Newton", "Moore-Penrose")
    )


def default_controller_is_on_the_front(engine_controllers):
    far = chart.excess(engine_controllers, "end_point", "factorizations")
    own = [value for row, value in zip(engine_controllers.rows, far) if row.method == "Allgower-Georg (DEFAULT)"]
    least = min(total(engine_controllers, name) for name in engine_controllers.methods)
    return median(own) == 1.0 and max(own) <= 1.75 and total(engine_controllers, "Allgower-Georg (DEFAULT)") == least


def geometric_is_dear(engine_controllers):
    return ratio(engine_controllers, "geometric (the paper's)", "Allgower-Georg (DEFAULT)") > 2.0


# -- metric, series ------------------------------------------------------------------------------------------------


def automatic_metric_is_good(engine_metrics):
    own = total(engine_metrics, "automatic (the default)")
    return (
        solved(engine_metrics, "automatic (the default)") == 1.0
        and own <= total(engine_metrics, "Euclidean")
        and own < total(engine_metrics, "root mean square")
    )


def pade_pays(engine_series):
    pairs = (("1e-05 (SERIES)", "1e-05"), ("1e-07", "1e-07"))
    return all(
        total(engine_series, f"Pade, accuracy {a}") < 0.75 * total(engine_series, f"series, accuracy {b}")
        for a, b in pairs
    )


def accuracy_is_the_best(engine_series):
    methods = [method for method in engine_series.methods if "Pade" in method]
    rejected = {m: sum(row.counts.rejected for row in engine_series.of(method=m)) for m in methods}
    own = "Pade, accuracy 1e-05 (SERIES)"
    return (
        total(engine_series, own) == min(total(engine_series, method) for method in methods)
        and rejected["Pade, accuracy 0.001"] > 50 + rejected[own]
    )


# -- linear complementarity ----------------------------------------------------------------------------------------


def kkt_solves_the_ten_examples(lcp_paper):
    return solved(lcp_paper, "KKT") == 1.0 and all(solved(lcp_paper, name) < 1.0 for name in IN_XY)


def solve_is_cheaper_than_the_path(lcp_paper):
    least = {row.problem: row.work("factorizations") for row in lcp_paper.of(method="KKT")}
    cheaper = [row.work("factorizations") < least[row.problem] for row in lcp_paper.of(method="solve, auto")]
    return solved(lcp_paper, "solve, auto") == 1.0 and sum(cheaper) >= 0.8 * len(cheaper)


def references_fail_on_some(lcp_paper):
    names = ("Lemke", "modulus", "min-Newton")
    dear = median_excess(lcp_paper, "KKT")
    return all(0.0 < solved(lcp_paper, name) < 1.0 and median_excess(lcp_paper, name) < dear for name in names)


def modulus_makes_many_solves(lcp_paper):
    rows = [row for row in lcp_paper.of(method="modulus") if not row.failed]
    return all(row.counts.factorizations == 1 and row.counts.solves > 20 for row in rows)


def kkt_solves_n_matrices(robustness):
    return solved(robustness, "KKT", family="N") == 1.0 and solved(robustness, "Wang", family="N") == 0.0


def wang_series_saves(scaling_lcp):
    return (
        solved(scaling_lcp, "Wang") == solved(scaling_lcp, "Wang, series") == 1.0
        and ratio(scaling_lcp, "Wang, series", "Wang") <= 0.85
    )


def kkt_fails_on_scaled_p(scaling_lcp):
    rows = [row for row in scaling_lcp.of(family="scaled P", method="KKT") if row.n >= 100]
    return all(row.failure == chart.Failure.BUDGET for row in rows)


def zhao_never_arrives(robustness):
    return solved(robustness, "Zhao") == 0.0


# -- size and robustness -------------------------------------------------------------------------------------------


def factorizations_do_not_grow(scaling_curves):
    counts = {}
    for row in scaling_curves.rows:
        counts.setdefault((row.family, row.method), []).append(row.work("factorizations"))
    return all(max(each) < 1.5 * min(each) for each in counts.values())


def series_comes_nearer_with_size(scaling_curves):
    rows = scaling_curves.of(family="H-equation (dense)")
    seconds = {(row.method, row.n): row.seconds for row in rows}
    first, last = (seconds["SERIES", n] / seconds["DEFAULT", n] for n in (10, 1000))
    return 2.5 < first < 6.0 and 1.0 < last < min(2.0, first / 1.5)


def solve_is_robust_where_theory_says_so(robustness):
    return all(solved(robustness, "solve, auto", family=f) == 1.0 for f in ("semidefinite", "scaled P", "copositive"))


def other_paths_fail_on_indefinite(robustness):
    return solved(robustness, "KKT", family="indefinite") == 1.0 and all(
        solved(robustness, name, family="indefinite") < 1.0 for name in IN_XY
    )
