"""``python -m continuation``: the command line, where the script is not on the path."""

import sys

from continuation.version import __version__

if sys.argv[1:] == ["--version"]:
    # Said at once: the commands import all that they may need.
    print(f"continuation {__version__}")
    sys.exit()

from continuation.cli import main

sys.exit(main())
