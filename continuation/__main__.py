"""``python -m continuation``: the command line, where the script is not on the path."""

import sys

from continuation.cli import main

sys.exit(main())
