"""What docs/choosing.md states of scenes, as tests on their charts; `choosing_claims` has the rest."""

import math
from statistics import median

from choosing_claims import ratio, solved

from problems.charts.scenes import MESHES


def _at(results, problem, method, rung=None):
    """The row of a scene and a method, on the finest mesh unless said."""
    (row,) = results.of(problem=problem, method=method, rung=_finest(results) if rung is None else rung)
    return row


def _finest(results):
    return max(row.rung for row in results.rows)


def scenes_are_all_answered(scenes):
    return solved(scenes, "ours") == 1.0


def mesh_errors_are_second_order(scenes):
    coarse, fine = (_at(scenes, "torsion", "ours", rung).errors["answer"] for rung in (0.5, 2.0))
    return 15.0 < coarse / fine < 17.0


def ours_beats_bfgs_on_fine_meshes(scenes):
    return all(
        2.0 * _at(scenes, scene, "ours").seconds < _at(scenes, scene, "L-BFGS-B (scipy)").seconds
        for scene in ("membrane", "bearing", "torsion")
    )


def brennan_schwartz_is_quicker(scenes):
    return ratio(scenes, "ours", "Brennan-Schwartz", "seconds") > 2.0


def pooling_is_quicker(scenes):
    pooled = _at(scenes, "isotonic", "pool adjacent violators")
    return _at(scenes, "isotonic", "ours").seconds > 8.0 * pooled.seconds


def nnls_is_as_exact(scenes):
    return all(_at(scenes, "unmixing", method).errors["answer"] < 1e-12 for method in ("ours", "nnls (scipy)"))


def bfgs_leaves_errors(scenes):
    return all(
        _at(scenes, scene, "ours").errors["answer"] < 1e-12
        and _at(scenes, scene, "L-BFGS-B (scipy)").errors["answer"] > 1e-9
        for scene in ("isotonic", "denoising")
    )


def lemke_is_quick_on_small_scenes(scenes):
    tables = "Lemke (tables, numpy)"
    small = ("block", "box", "braess", "diode-bridge")

    def gain(method):
        """Our time over that of the method, median over the scenes; infinite where it takes no part."""
        rows = [row for row in scenes.of(method=method) if row.problem in small]
        return median([_at(scenes, row.problem, "ours", row.rung).seconds / row.seconds for row in rows] or [math.inf])

    return gain(tables) > 2.0 and gain("Lemke (quantecon)") > 8.0 and _at(scenes, "painleve-rod", tables).failed


def _where_asked(results, method, test):
    """Whether a test holds of every row of an outside method; these take part only in charts with `--compare`."""
    return all(test(row) for row in results.of(method=method))


def piqp_is_quicker_and_less_exact(scenes):
    def holds(row):
        ours = _at(scenes, row.problem, "ours", row.rung)
        return (
            (row.problem not in MESHES or row.seconds < ours.seconds)
            and (row.problem != "traffic" or 10.0 * row.seconds < ours.seconds)
            and (row.problem != "unmixing" or row.errors["answer"] > 1e-5)
        )

    return _where_asked(scenes, "PIQP", holds)


def gauss_seidel_slows_down(scenes):
    return _where_asked(
        scenes,
        "projected Gauss-Seidel (numba)",
        lambda row: (
            row.problem not in MESHES
            or row.problem == "string"
            or row.rung < _finest(scenes)
            or row.seconds > 5.0 * _at(scenes, row.problem, "ours").seconds
        ),
    )
