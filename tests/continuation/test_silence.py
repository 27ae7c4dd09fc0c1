"""Numpy's warnings: off in a Silence and in what is decorated, on again behind it, and of other threads no concern."""

import threading
import warnings

import numpy as np
import pytest

from continuation.linear.silence import Silence, silent, without_warnings


def warned(call):
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        call()
    return len(seen)


def divided():
    return 1.0 / np.zeros(1)


def test_it_ends_with_the_block_and_with_an_error_and_another_thread_still_warns():
    heard, outer = [], np.geterr()
    thread = threading.Thread(target=lambda: heard.append((silent(), warned(divided))))

    def fail():
        with Silence(), Silence():
            assert (silent(), warned(divided)) == (True, 0)
            thread.start()
            thread.join()
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert heard == [(False, 1)]
    assert (silent(), np.geterr()) == (False, outer)


def test_what_is_decorated_ignores_what_it_names():
    assert warned(lambda: without_warnings(divide="ignore")(divided)()) == 0
    assert warned(lambda: without_warnings(over="ignore")(divided)()) == 1
    assert without_warnings(over="ignore")(divided).__name__ == "divided"
