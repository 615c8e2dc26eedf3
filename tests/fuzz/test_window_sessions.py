"""A short session of real events in a window, by the program that runs long ones."""

import sys

from child_process import ROOT, finished


def test_a_session_goes_right():
    words = ["--count", "1", "--first", "3", "--actions", "60"]
    done = finished([sys.executable, str(ROOT / "tests" / "fuzz" / "window_sessions.py"), *words])
    assert done.returncode == 0, done.stdout[-3000:] + done.stderr[-3000:]
    assert "1 sessions of 60 actions, 0 wrong" in done.stdout
