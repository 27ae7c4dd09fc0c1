"""``continuation trace`` and ``check``: any homotopy by its name, from a shell."""

import pytest

from continuation.archive import open_archive
from continuation.cli import FAILURE
from tests.truth import bratu


def test_trace_by_name_with_archive_and_plot(run, tmp_path):
    archive, picture = tmp_path / "run.h5", tmp_path / "run.png"
    out = run(
        "trace", "bratu-1d", "n=100", "--turning-points", 1, "--archive", archive, "--plot", picture, "--progress",
        "--preset", "series",
    ).out  # fmt: skip
    assert "STOPPED_AT_EVENT" in out
    assert picture.read_bytes().startswith(b"\x89PNG")
    with open_archive(archive) as stored:
        assert stored.attributes["homotopy_entry_point"] == "bratu-1d"
        assert stored.path(0).endpoint.lam == pytest.approx(bratu.FOLD_1D[100][0], abs=1e-10)


def test_a_homotopy_without_target_is_asked_for_none(run):
    out = run("trace", "pitchfork", "--target", "none", "--budget-steps", 5, "--direction", "-1", status=FAILURE).out
    end = next(line for line in out.splitlines() if line.startswith("end"))
    assert float(end.split("=")[1]) < -1.0


def test_check_says_what_is_wrong_with_a_homotopy_of_the_working_directory(run, own):
    run("check", f"{own}:Own", "--steps", 4)
    out = run("check", f"{own}:Wrong", "--steps", 4, status=FAILURE).out
    assert "failed   jacobian\n" in out
    assert "H_y[0, 0] is 2, expected 1 (by jets), at the start" in out
    assert out.strip().endswith("checks passed.")
