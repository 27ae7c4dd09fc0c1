"""Ctrl-C: nothing that was traced is lost, the interrupt reaches the caller, and INTERRUPTED means a person alone."""

import pickle

import pytest

from continuation import Interrupted, Status, Tracer
from continuation.archive import trace_many
from continuation.cli import main
from problems.bifurcation import Cusp


class Pressed(Cusp):
    """Ctrl-C is pressed where the parameter exceeds 0.2."""

    def residual(self, y, lam):
        if lam > 0.2:
            raise KeyboardInterrupt
        return super().residual(y, lam)


def test_a_sweep_hands_over_what_it_has():
    with pytest.raises(Interrupted) as interrupt:
        trace_many([Cusp(), Pressed(), Cusp()])
    assert [path.status for path in interrupt.value.paths] == [Status.REACHED_TARGET, Status.INTERRUPTED]
    assert str(pickle.loads(pickle.dumps(interrupt.value))) == str(interrupt.value)


def test_the_shell_says_what_is_kept(tmp_path, capsys):
    assert main(["trace", f"{__name__}:Pressed", "--archive", str(tmp_path / "run.h5")]) == 130
    out, err = capsys.readouterr()
    assert (out, err.count("\n")) == ("", 1)
    assert err.startswith("continuation: interrupted after ")
    assert err.endswith(f"; what was traced is in {tmp_path / 'run.h5'}\n")


def test_a_loop_that_is_left_has_words_of_its_own():
    tracer = Tracer(Cusp())
    for step in tracer:
        if step.index == 2:
            tracer.give_up("two steps are enough")
            break
    assert tracer.path.status is Status.ABANDONED
    assert tracer.path.message.endswith("Given up: two steps are enough.")
    assert tracer.run().status is Status.REACHED_TARGET
