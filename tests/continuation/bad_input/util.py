"""What every refusal has to be: an exception of one line that begins with the argument at fault."""

import pytest

from continuation.archive import ArchiveError

REFUSALS = (TypeError, ValueError, LookupError, ArchiveError)


def refused(argument, call):
    """The call is refused with a line about the argument, or the file of that name; warnings are errors here."""
    with pytest.raises(REFUSALS) as caught:
        call()
    text = str(caught.value.args[0] if isinstance(caught.value, KeyError) else caught.value)
    assert "\n" not in text
    assert text.startswith(f"{argument}: "), text
    assert len(text) < 400
