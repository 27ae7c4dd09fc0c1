"""What docs/choosing.md states, as tests on the results of the studies, by the names that the page gives them."""

import math
from statistics import median

from continuation import chart

SERIES = ("Taylor + series range", "Pade + series range")
PATHS = ("KKT", "Wang", "Yu", "Xu", "Zhao", "Kojima")
IN_XY = PATHS[1:]


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


def series_needs_fewest_factorizations(charts):
    results = charts["engine-presets"]
    return all(total(results, "SERIES") < total(results, name) for name in PRESETS[:3]) and (
        2.0 < total(results, "DEFAULT") / total(results, "SERIES") < 2.8
    )


def other_software_jumps(charts):
    results = charts["engine-presets"]
    rows = [row for row in results.of(problem="exponential-cosine, n = 5") if row.outside and row.failed]
    return all(row.method != "PITCON (dense)" for row in rows) and any(row.failure == "wrong end" for row in rows)


def pitcon_is_quick_on_small_dense_systems(charts):
    results = charts["engine-presets"]

    def seconds(method, kind):
        rows = [row for row in results.of(method=method) if row.problem.startswith(kind) and not row.failed]
        return median(row.seconds for row in rows) if rows else None

    small, large = (seconds("PITCON (dense)", kind) for kind in ("exponential-cosine, n = 5", "Bratu 2D"))
    return small is None or (
        5.0 * small < seconds("DEFAULT", "exponential-cosine, n = 5") and large > 2.0 * seconds("DEFAULT", "Bratu 2D")
    )


def series_is_slow_on_small_problems(charts):
    return ratio(charts["engine-presets"], "SERIES", "DEFAULT", "seconds") > 1.5


def conservative_costs_several_times_default(charts):
    return ratio(charts["engine-presets"], "CONSERVATIVE", "DEFAULT") > 3.0


def presets_never_fail(charts):
    results = charts["engine-presets"]
    return all(solved(results, name) == 1.0 for name in PRESETS)


def fast_saves_an_eighth(charts):
    return 0.83 < ratio(charts["engine-presets"], "FAST", "DEFAULT") < 0.92


def tolerance_is_cheap(charts):
    results = charts["engine-presets"]
    work = [total(results, "DEFAULT", rung=rung) for rung in sorted({row.rung for row in results.rows})]
    return max(work) <= 1.15 * min(work)


# -- predictors ----------------------------------------------------------------------------------------------------


def hermite_is_near_the_best(charts):
    results = charts["engine-predictors"]
    others = [m for m in results.methods if m not in SERIES and solved(results, m) == 1.0]
    return total(results, "Hermite (DEFAULT)") <= 1.1 * min(total(results, m) for m in others)


def secant_is_worse(charts):
    results = charts["engine-predictors"]
    return 1.1 < ratio(results, "secant", "Hermite (DEFAULT)") < 1.3 and 11 / 12 <= solved(results, "tangent") < 1.0


def series_and_pade_pay(charts):
    results = charts["engine-predictors"]
    series, pade = SERIES
    return (
        0.5 < total(results, series) / total(results, "Hermite (DEFAULT)") < 0.65
        and total(results, pade) < 0.8 * total(results, series)
    )  # fmt: skip


def series_has_the_best_dense_output(charts):
    results = charts["engine-steps"]
    rungs = sorted({row.rung for row in results.rows})

    def error(problem, method, rung):
        (row,) = (r for r in results.of(problem=problem, method=method) if r.rung == rung)
        return row.errors["curve_distance"]

    return all(
        100.0 * error(p, SERIES[0], rungs[-1]) < error(p, "Hermite (DEFAULT)", rungs[0]) for p in results.problems
    )


# -- correctors and controllers ------------------------------------------------------------------------------------

DEFAULT_CORRECTOR = "bordered, reuse 0.2 (DEFAULT)"


def reuse_saves_factorizations(charts):
    results = charts["engine-correctors"]
    return all(
        ratio(results, name, DEFAULT_CORRECTOR) > 2.0 and ratio(results, name, DEFAULT_CORRECTOR, "solves") < 1.0
        for name in ("bordered Newton", "Moore-Penrose")
    )


def broyden_saves_nothing(charts):
    results = charts["engine-correctors"]
    return solved(results, "Broyden") == 1.0 and all(
        1.0 < ratio(results, "Broyden", DEFAULT_CORRECTOR, work) < 1.15 for work in ("factorizations", "solves")
    )


def broyden_loses_on_larger_systems(charts):
    results = charts["scaling-curves"]
    largest = max(row.n for row in results.of(family="H-equation (dense)"))
    where = {"family": "H-equation (dense)", "n": largest}
    return total(results, "DEFAULT, Broyden", **where) > 1.3 * total(results, "DEFAULT", **where)


def linear_correctors_dislike_tight_tolerances(charts):
    results = charts["engine-correctors"]
    rungs = sorted({row.rung for row in results.rows})

    def growth(name):
        """Of the factorisations from the loosest tolerance to the tightest, over problems where every run arrived."""
        whole = [p for p in results.problems if not any(row.failed for row in results.of(problem=p, method=name))]
        first, last = (sum(total(results, name, problem=p, rung=rung) for p in whole) for rung in (rungs[-1], rungs[0]))
        return last / first

    return all(growth(name) > 1.1 for name in ("Broyden", "chord"))


def default_controller_is_on_the_front(charts):
    results = charts["engine-controllers"]
    far = chart.excess(results, "end_point", "factorizations")
    own = [value for row, value in zip(results.rows, far) if row.method == "Allgower-Georg (DEFAULT)"]
    least = min(total(results, name) for name in results.methods)
    return median(own) == 1.0 and max(own) <= 1.75 and total(results, "Allgower-Georg (DEFAULT)") == least


def geometric_is_dear(charts):
    return ratio(charts["engine-controllers"], "geometric (the paper's)", "Allgower-Georg (DEFAULT)") > 2.0


# -- metric, series ------------------------------------------------------------------------------------------------


def automatic_metric_is_good(charts):
    results = charts["engine-metrics"]
    own = total(results, "automatic (the default)")
    return (
        solved(results, "automatic (the default)") == 1.0
        and own <= total(results, "Euclidean")
        and own < total(results, "root mean square")
    )


def pade_pays(charts):
    results = charts["engine-series"]
    pairs = (("1e-05 (SERIES)", "1e-05"), ("1e-07", "1e-07"))
    return all(total(results, f"Pade, accuracy {a}") < 0.75 * total(results, f"series, accuracy {b}") for a, b in pairs)


def accuracy_is_the_best(charts):
    results = charts["engine-series"]
    methods = [method for method in results.methods if "Pade" in method]
    rejected = {m: sum(row.counts.rejected for row in results.of(method=m)) for m in methods}
    own = "Pade, accuracy 1e-05 (SERIES)"
    return (
        total(results, own) == min(total(results, method) for method in methods)
        and rejected["Pade, accuracy 0.001"] > 50 + rejected[own]
    )


# -- linear complementarity ----------------------------------------------------------------------------------------


def kkt_solves_the_ten_examples(charts):
    results = charts["lcp-paper"]
    return solved(results, "KKT") == 1.0 and all(solved(results, name) < 1.0 for name in IN_XY)


def solve_is_cheaper_than_the_path(charts):
    results = charts["lcp-paper"]
    least = {row.problem: row.work("factorizations") for row in results.of(method="KKT")}
    cheaper = [row.work("factorizations") < least[row.problem] for row in results.of(method="solve, auto")]
    return solved(results, "solve, auto") == 1.0 and sum(cheaper) >= 0.8 * len(cheaper)


def references_fail_on_some(charts):
    results = charts["lcp-paper"]
    names = ("Lemke", "modulus", "min-Newton")
    dear = median_excess(results, "KKT")
    return all(0.0 < solved(results, name) < 1.0 and median_excess(results, name) < dear for name in names)


def modulus_makes_many_solves(charts):
    rows = [row for row in charts["lcp-paper"].of(method="modulus") if not row.failed]
    return all(row.counts.factorizations == 1 and row.counts.solves > 20 for row in rows)


def kkt_solves_n_matrices(charts):
    results = charts["robustness"]
    return solved(results, "KKT", family="N") == 1.0 and solved(results, "Wang", family="N") == 0.0


def wang_series_saves(charts):
    results = charts["lcp-generated"]
    return (
        solved(results, "Wang") == solved(results, "Wang, series") == 1.0
        and ratio(results, "Wang, series", "Wang") <= 0.75
    )


def kkt_fails_on_scaled_p(charts):
    rows = [row for row in charts["lcp-generated"].of(family="scaled P", method="KKT") if row.n == 100]
    return all(row.failure == chart.Failure.BUDGET for row in rows)


def zhao_never_arrives(charts):
    return solved(charts["lcp-generated"], "Zhao") == 0.0


# -- size and robustness -------------------------------------------------------------------------------------------


def factorizations_do_not_grow(charts):
    return all(abs(p) < 0.25 for p in chart.exponents(charts["scaling-curves"], "factorizations").values())


def series_comes_nearer_with_size(charts):
    rows = charts["scaling-curves"].of(family="H-equation (dense)")
    seconds = {(row.method, row.n): row.seconds for row in rows}
    first, last = (seconds["SERIES", n] / seconds["DEFAULT", n] for n in (10, 1000))
    return first > 4.0 and 1.5 < last < 3.0


def solve_is_robust_where_theory_says_so(charts):
    results = charts["robustness"]
    return all(solved(results, "solve, auto", family=f) == 1.0 for f in ("semidefinite", "scaled P", "copositive"))


def pure_paths_fail_on_indefinite(charts):
    return all(solved(charts["robustness"], name, family="indefinite") < 1.0 for name in PATHS)
