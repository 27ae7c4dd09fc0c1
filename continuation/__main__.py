"""``python -m continuation``: the command line without the script."""

import sys

from continuation.version import __version__

if sys.argv[1:] == ["--version"]:
    # Quick: the commands import much.
    print(f"continuation {__version__}")
    sys.exit()

from continuation.cli import main

sys.exit(main())
