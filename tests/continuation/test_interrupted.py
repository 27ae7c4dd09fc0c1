"""Ctrl-C: nothing that was traced is lost, the interrupt reaches the caller, and INTERRUPTED means a person alone."""

import pickle

import pytest

from continuation import Interrupted, Status, Tracer, trace
from continuation.archive import open_archive, resume, trace_many
from continuation.cli import main
from problems import lcp
from problems.bifurcation import Cusp


class Pressed(Cusp):
    """Ctrl-C is pressed where the parameter exceeds 0.2."""

    def residual(self, y, lam):
        if lam > 0.2:
            raise KeyboardInterrupt
        return super().residual(y, lam)


def test_a_loop_of_traces_ends_at_the_first(tmp_path):
    begun = []

    def loop():
        for k in range(6):
            begun.append(k)
            trace(Pressed(), archive=tmp_path / f"{k}.h5")

    with pytest.raises(KeyboardInterrupt) as interrupt:
        loop()
    assert begun == [0]
    path = interrupt.value.path
    assert path.status is Status.INTERRUPTED
    assert len(path) > 1
    with open_archive(tmp_path / "0.h5") as archive:
        assert archive.path(0).status is Status.INTERRUPTED
        assert (archive.path(0).u == path.u).all()
    whole = trace(Cusp())
    assert (resume(tmp_path / "0.h5", Cusp()).u == whole.u).all()


def test_a_sweep_hands_over_what_it_has():
    with pytest.raises(Interrupted) as interrupt:
        trace_many([Cusp(), Pressed(), Cusp()])
    assert [path.status for path in interrupt.value.paths] == [Status.REACHED_TARGET, Status.INTERRUPTED]
    again = pickle.loads(pickle.dumps(interrupt.value))
    assert str(again) == str(interrupt.value)


def test_a_solve_ends(monkeypatch, tmp_path):
    calls = []

    def pressed(self, y, lam):
        calls.append(lam)
        raise KeyboardInterrupt

    monkeypatch.setattr(lcp.KKTHomotopy, "residual", pressed)
    with pytest.raises(KeyboardInterrupt):
        lcp.solve(lcp.LCP([[1.0, -1.0], [-1.0, 1.0]], [-0.5, 2.0]), "kkt", restarts=50)
    assert len(calls) == 1


def test_the_shell_says_what_is_kept(tmp_path, monkeypatch, capsys):
    residual = Cusp.residual

    def pressed(self, y, lam):
        if lam > 0.2:
            raise KeyboardInterrupt
        return residual(self, y, lam)

    monkeypatch.setattr(Cusp, "residual", pressed)
    file = tmp_path / "run.h5"
    assert main(["trace", "cusp", "--archive", str(file)]) == 130
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert err.startswith("continuation: interrupted after ")
    assert err.endswith(f"; what was traced is in {file}\n")


def test_a_loop_that_is_left_and_an_exception_have_words_of_their_own():
    tracer = Tracer(Cusp())
    for step in tracer:
        if step.index == 2:
            tracer.give_up("two steps are enough")
            break
    assert tracer.path.status is Status.ABANDONED
    assert tracer.path.message.endswith("Given up: two steps are enough.")
    assert tracer.run().status is Status.REACHED_TARGET
