"""The command ``imagechain``, also available as ``python -m imagechain``."""

import sys


def main() -> int:
    """Run the command line and return the exit code."""
    from app.command.cli import main as command

    return command()


if __name__ == "__main__":
    sys.exit(main())
