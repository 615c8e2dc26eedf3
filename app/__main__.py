"""``python -m app`` is the same command."""

import sys

from app.command.cli import main

if __name__ == "__main__":
    sys.exit(main())
