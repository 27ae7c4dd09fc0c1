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


def scenes_are_all_answered(scenes_meshes, scenes_exact):
    return solved(scenes_meshes, "ours") == solved(scenes_exact, "ours") == 1.0


def mesh_errors_are_second_order(scenes_meshes):
    coarse, fine = (_at(scenes_meshes, "torsion", "ours", rung).errors["answer"] for rung in (0.5, 2.0))
    return 15.0 < coarse / fine < 17.0


def ours_beats_bfgs_on_fine_meshes(scenes_meshes):
    rung = _finest(scenes_meshes)
    return all(
        2.0 * _at(scenes_meshes, scene, "ours", rung).seconds
        < _at(scenes_meshes, scene, "L-BFGS-B (scipy)", rung).seconds
        for scene in ("membrane", "bearing", "torsion")
    )


def brennan_schwartz_is_quicker(scenes_meshes):
    return ratio(scenes_meshes, "ours", "Brennan-Schwartz", "seconds") > 2.0


def pooling_is_quicker(scenes_exact):
    pooled = _at(scenes_exact, "isotonic", "pool adjacent violators")
    return _at(scenes_exact, "isotonic", "ours").seconds > 8.0 * pooled.seconds


def nnls_is_as_exact(scenes_exact):
    return all(_at(scenes_exact, "unmixing", method).errors["answer"] < 1e-12 for method in ("ours", "nnls (scipy)"))


def bfgs_leaves_errors(scenes_exact):
    return all(
        _at(scenes_exact, scene, "ours").errors["answer"] < 1e-12
        and _at(scenes_exact, scene, "L-BFGS-B (scipy)").errors["answer"] > 1e-9
        for scene in ("isotonic", "denoising")
    )


def lemke_is_quick_on_small_scenes(scenes_exact):
    tables = "Lemke (tables, numpy)"
    small = ("block", "box", "braess", "diode-bridge")

    def gain(method):
        """Our time over that of the method, median over the scenes; infinite where it takes no part."""
        rows = [row for row in scenes_exact.of(method=method) if row.problem in small]
        return median([_at(scenes_exact, row.problem, "ours").seconds / row.seconds for row in rows] or [math.inf])

    return gain(tables) > 2.0 and gain("Lemke (quantecon)") > 8.0 and _at(scenes_exact, "painleve-rod", tables).failed


def _where_asked(results, method, test):
    """Whether a test holds of every row of an outside method; these take part only in charts with `--compare`."""
    return all(test(row) for row in results.of(method=method))


def piqp_is_quicker_and_less_exact(scenes_meshes, scenes_exact):
    return _where_asked(
        scenes_meshes, "PIQP", lambda row: row.seconds < _at(scenes_meshes, row.problem, "ours", row.rung).seconds
    ) and _where_asked(
        scenes_exact,
        "PIQP",
        lambda row: (
            (row.problem != "traffic" or 10.0 * row.seconds < _at(scenes_exact, "traffic", "ours").seconds)
            and (row.problem != "unmixing" or row.errors["answer"] > 1e-5)
        ),
    )


def gauss_seidel_slows_down(scenes_meshes):
    return _where_asked(
        scenes_meshes,
        "projected Gauss-Seidel (numba)",
        lambda row: (
            row.rung < 2.0
            or row.problem == "string"
            or row.seconds > 5.0 * _at(scenes_meshes, row.problem, "ours", row.rung).seconds
        ),
    )
