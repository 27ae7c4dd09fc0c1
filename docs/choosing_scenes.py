"""What docs/choosing.md states of scenes: conditions on the results of their study, by name."""

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


def mesh_errors_are_second_order(scenes):
    coarse, fine = (_at(scenes, "torsion", "ours", rung).errors["answer"] for rung in (0.5, 2.0))
    return 15.0 < coarse / fine < 17.0


def lemke_is_quick_on_small_scenes(scenes):
    def gain(method):
        """Our time over that of the method, median over the scenes; infinite where it takes no part."""
        rows = [row for row in scenes.of(method=method) if row.problem in ("block", "box", "braess")]
        return median([_at(scenes, row.problem, "ours", row.rung).seconds / row.seconds for row in rows] or [math.inf])

    tables = "Lemke (tables, numpy)"
    return gain(tables) > 2.0 and gain("Lemke (quantecon)") > 8.0


def piqp_is_quicker_and_less_exact(scenes):
    return all(
        (row.problem not in MESHES or row.seconds < _at(scenes, row.problem, "ours", row.rung).seconds)
        and (row.problem != "traffic" or 10.0 * row.seconds < _at(scenes, row.problem, "ours", row.rung).seconds)
        and (row.problem != "unmixing" or row.errors["answer"] > 1e-5)
        for row in scenes.of(method="PIQP")
    )


CLAIMS = {
    "scenes_are_all_answered": lambda r: solved(r, "ours") == 1.0,
    "mesh_errors_are_second_order": mesh_errors_are_second_order,
    "ours_beats_bfgs_on_fine_meshes": lambda r: all(
        2.0 * _at(r, scene, "ours").seconds < _at(r, scene, "L-BFGS-B (scipy)").seconds
        for scene in ("membrane", "bearing", "torsion")
    ),
    "brennan_schwartz_is_quicker": lambda r: ratio(r, "ours", "Brennan-Schwartz", "seconds") > 1.5,
    "pooling_is_quicker": lambda r: (
        _at(r, "isotonic", "ours").seconds > 8.0 * _at(r, "isotonic", "pool adjacent violators").seconds
    ),
    "nnls_is_as_exact": lambda r: all(
        _at(r, "unmixing", method).errors["answer"] < 1e-12 for method in ("ours", "nnls (scipy)")
    ),
    "bfgs_leaves_errors": lambda r: all(
        _at(r, scene, "ours").errors["answer"] < 1e-12 and _at(r, scene, "L-BFGS-B (scipy)").errors["answer"] > 1e-9
        for scene in ("isotonic", "denoising")
    ),
    "lemke_is_quick_on_small_scenes": lemke_is_quick_on_small_scenes,
    # PIQP takes part only in charts with `--compare`.
    "piqp_is_quicker_and_less_exact": piqp_is_quicker_and_less_exact,
}
