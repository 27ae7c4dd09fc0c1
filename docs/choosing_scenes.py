"""What docs/choosing.md states of scenes, as tests on their charts; `choosing_claims` has the rest."""

import math
from statistics import median

from choosing_claims import ratio, solved


def _at(results, problem, method, rung=None):
    """The one row of a scene and a method, on a mesh where there are several."""
    rows = [row for row in results.of(problem=problem, method=method) if rung is None or row.rung == rung]
    (row,) = rows
    return row


def _finest(results):
    return max(row.rung for row in results.rows)


def scenes_are_all_answered(charts):
    return all(solved(charts[name], "ours") == 1.0 for name in ("scenes-meshes", "scenes-exact"))


def mesh_errors_are_second_order(charts):
    results = charts["scenes-meshes"]
    coarse, fine = (_at(results, "torsion", "ours", rung).errors["answer"] for rung in (0.5, 2.0))
    return 15.0 < coarse / fine < 17.0


def ours_beats_bfgs_on_fine_meshes(charts):
    results = charts["scenes-meshes"]
    rung = _finest(results)
    return all(
        2.0 * _at(results, scene, "ours", rung).seconds < _at(results, scene, "L-BFGS-B (scipy)", rung).seconds
        for scene in ("membrane", "bearing", "torsion")
    )


def brennan_schwartz_is_quicker(charts):
    return ratio(charts["scenes-meshes"], "ours", "Brennan-Schwartz", "seconds") > 2.0


def pooling_is_quicker(charts):
    results = charts["scenes-exact"]
    pooled = _at(results, "isotonic", "pool adjacent violators")
    return _at(results, "isotonic", "ours").seconds > 8.0 * pooled.seconds


def nnls_is_as_exact(charts):
    results = charts["scenes-exact"]
    return all(_at(results, "unmixing", method).errors["answer"] < 1e-12 for method in ("ours", "nnls (scipy)"))


def bfgs_leaves_errors(charts):
    results = charts["scenes-exact"]
    return all(
        _at(results, scene, "ours").errors["answer"] < 1e-12
        and _at(results, scene, "L-BFGS-B (scipy)").errors["answer"] > 1e-9
        for scene in ("isotonic", "denoising")
    )


def lemke_is_quick_on_small_scenes(charts):
    results, tables = charts["scenes-exact"], "Lemke (tables, numpy)"
    small = ("block", "box", "braess", "diode-bridge")

    def gain(method):
        """Our time over that of the method, median over the scenes; infinite where it takes no part."""
        rows = [row for row in results.of(method=method) if row.problem in small]
        return median([_at(results, row.problem, "ours").seconds / row.seconds for row in rows] or [math.inf])

    return gain(tables) > 2.0 and gain("Lemke (quantecon)") > 8.0 and _at(results, "painleve-rod", tables).failed


def _where_asked(results, method, test):
    """Whether a test holds of every row of an outside method; these take part only in charts with `--compare`."""
    return all(test(row) for row in results.of(method=method))


def piqp_is_quicker_and_less_exact(charts):
    meshes, exact = charts["scenes-meshes"], charts["scenes-exact"]
    return _where_asked(
        meshes, "PIQP", lambda row: row.seconds < _at(meshes, row.problem, "ours", row.rung).seconds
    ) and _where_asked(
        exact,
        "PIQP",
        lambda row: (
            (row.problem != "traffic" or 10.0 * row.seconds < _at(exact, "traffic", "ours").seconds)
            and (row.problem != "unmixing" or row.errors["answer"] > 1e-5)
        ),
    )


def gauss_seidel_slows_down(charts):
    results = charts["scenes-meshes"]
    return _where_asked(
        results,
        "projected Gauss-Seidel (numba)",
        lambda row: (
            row.rung < 2.0
            or row.problem == "string"
            or row.seconds > 5.0 * _at(results, row.problem, "ours", row.rung).seconds
        ),
    )
