"""``python -m app`` is the same command."""

from __future__ import annotations

import sys

from app.command.cli import main

if __name__ == "__main__":
    sys.exit(main())
