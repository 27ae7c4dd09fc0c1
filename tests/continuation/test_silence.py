"""Numpy's warnings: off in a Silence and in what is decorated, on again behind it, and of other threads no concern."""

import threading
import warnings

import numpy as np
import pytest

from continuation.linear.silence import Silence, silent, without_warnings


@without_warnings(over="ignore")
def square(x):
    return x * x


def warned(call):
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        call()
    return len(seen)


def test_it_ends_with_the_block_and_with_an_error():
    def fail():
        with Silence(), Silence():
            assert silent()
            assert set(np.geterr().values()) == {"ignore"}
            raise KeyError

    outer = np.geterr()
    with pytest.raises(KeyError):
        fail()
    assert not silent()
    assert np.geterr() == outer


def test_what_is_decorated_ignores_what_it_names():
    large, zero = np.full(1, 1e300), np.zeros(1)
    assert warned(lambda: square(large)) == 0
    assert warned(lambda: without_warnings(over="ignore")(lambda: 1.0 / zero)()) == 1
    with Silence():
        assert warned(lambda: 1.0 / zero) == 0
    assert square.__name__ == "square"


def test_another_thread_still_warns():
    heard = []
    with Silence():
        thread = threading.Thread(target=lambda: heard.append((silent(), warned(lambda: 1.0 / np.zeros(1)))))
        thread.start()
        thread.join()
    assert heard == [(False, 1)]
