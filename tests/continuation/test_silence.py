"""Numpy's warnings: off in a Silence and in what is decorated, on behind it and in other threads."""

import warnings
from concurrent.futures import ThreadPoolExecutor

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


def test_it_ends_with_the_block_and_another_thread_still_warns():
    outer = np.geterr()
    with Silence(), Silence(), ThreadPoolExecutor(1) as other:
        assert (silent(), warned(divided)) == (True, 0)
        assert other.submit(lambda: (silent(), warned(divided))).result() == (False, 1)
    with pytest.raises(KeyError), Silence():
        raise KeyError
    assert (silent(), np.geterr()) == (False, outer)


def test_what_is_decorated_ignores_what_it_names():
    assert warned(lambda: without_warnings(divide="ignore")(divided)()) == 0
    assert warned(lambda: without_warnings(over="ignore")(divided)()) == 1
    assert without_warnings(over="ignore")(divided).__name__ == "divided"
