"""Closings of real windows by real keys, mouse and signals: each ends the process or asks.

    python tests/fuzz/closings.py --count 50

So many by each of five ways (Ctrl+Q, File > Quit, the window manager's button, SIGTERM, and that
twice), over four states (unmodified, modified, computing, with a dialog open). Needs Xvfb and
xdotool.
"""

import argparse
import collections
import contextlib
import sys
import tempfile
import threading
import traceback
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "support")]

from closing_trials import close, trials  # noqa: E402
from virtual_screen import virtual_screen  # noqa: E402


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=50, help="closings by each way")
    parser.add_argument("--first", type=int, default=0, help="number of the first by each way")
    parser.add_argument("--screens", type=int, default=2, help="how many at a time")
    options = parser.parse_args()
    waiting = collections.deque(trials(options.count, options.first))
    found = collections.Counter()
    lock = threading.Lock()

    def work():
        with contextlib.ExitStack() as stack:
            with lock:  # two that start at once may take the same display
                screen = stack.enter_context(virtual_screen(1100, 800))
            while True:
                with lock:
                    if not waiting:
                        return
                    trial = waiting.popleft()
                with tempfile.TemporaryDirectory() as folder:
                    try:
                        outcome = close(trial, folder, screen)
                    except Exception:
                        outcome = "WRONG"
                        with lock:
                            print(trial, traceback.format_exc(limit=3), flush=True)
                with lock:
                    found[trial.way, trial.state, outcome] += 1
                    print(f"{sum(found.values())}: {trial} {outcome}", flush=True)

    threads = [threading.Thread(target=work) for _ in range(options.screens)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for (way, state, outcome), count in sorted(found.items()):
        print(f"{way:15} {state:11} {outcome:6} {count:5}")
    wrong = sum(count for key, count in found.items() if key[2] == "WRONG")
    print(f"{sum(found.values())} closings, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
