"""`python -m sinuous` is the command `sinuous`."""

import sys

from sinuous.cli.app import main

if __name__ == "__main__":
    sys.exit(main())
