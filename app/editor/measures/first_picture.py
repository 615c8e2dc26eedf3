"""From the start of a process to the first picture of a network in the window.

Prints at which time of the system's monotonic clock the window and the picture were painted; the
caller has the time of the process's start.
"""

from __future__ import annotations

import json
import sys
import time

from app.editor.measures.trial_window import PaintedPictures, live, trial_window

PATIENCE_S = 60.0


def main(network: str) -> None:
    """Open the window with a network, and wait for the picture."""
    with trial_window() as (_, window):
        shown = time.monotonic()
        painted = PaintedPictures(window, window.viewers.images[1])
        window.files.open_now(network)
        while not painted.times and time.monotonic() < shown + PATIENCE_S:
            live(0.005)
        picture = painted.times[0] if painted.times else None
        print(json.dumps({"window": shown, "picture": picture}))


if __name__ == "__main__":
    main(sys.argv[1])
