"""``python -m arena_core``: the command line, where its script is not on the path."""

import sys

from arena_core.cli.main import main

if __name__ == "__main__":  # worker processes import this module, too
    sys.exit(main())
