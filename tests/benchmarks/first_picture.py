"""From the start of a process to the first picture of a network in the window.

The process goes the way of ``imagechain edit NETWORK``. Prints at which time of the system's
monotonic clock the picture was painted; the caller has the time of the process's start.
"""

import json
import sys
import time

import PySide6.QtWidgets  # noqa: F401  # before all that imports it, as the command does

from app.editor.qt_libraries import leave_sources_unread, names_looked_up, nothing_collected

PATIENCE_S = 60.0


def main(network: str) -> None:
    """Open the window with a network, and wait for the picture."""
    with nothing_collected(), names_looked_up():
        from trial_window import PaintedPictures, live, trial_window

    with trial_window(network) as (_, window):
        shown = time.monotonic()
        painted = PaintedPictures(window, window.viewers.images[1])
        while not painted.times and time.monotonic() < shown + PATIENCE_S:
            live(0.005)
        picture = painted.times[0] if painted.times else None
        print(json.dumps({"window": shown, "picture": picture}))


if __name__ == "__main__":
    leave_sources_unread()
    main(sys.argv[1])
