"""What the list says of a run, and how long it says a run still takes."""

from pathlib import Path

import pytest

from app.editor.docks.run_queue import Entry
from app.editor.docks.runs_view import duration, state_text, whole_text
from app.run.job import Job, Result


def entry(kind="sweep", **given):
    return Entry(1, "Small: 4 values", Job(kind, "", Path(), None, Path("/out")), **given)


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.04, "0.0 s"),
        (9.96, "10 s"),
        (3599, "60 min"),
        (7790, "2 h 10 min"),
    ],
)
def test_durations(seconds, words):
    assert duration(seconds) == words


def test_time_left_is_counted_from_the_first_step():
    """Half of it in 10 s, after 5 s of loading: 10 s are left."""
    running = entry(state="running", begun=100.0, first=(105.0, 0.0), share=0.5, doing="blur")
    assert running.left_s(115.0) == pytest.approx(10.0)
    assert state_text(running, 115.0) == "50 % · 10 s left · blur"


def test_ends_are_said_in_one_line():
    assert state_text(entry(), 0.0) == "waiting"
    assert state_text(entry(state="cancelled"), 0.0) == "cancelled"
    failed = entry(state="failed", text="blur: no such value")
    assert state_text(failed, 0.0) == "failed: blur: no such value"
    result = Result(4, (("a", "no file"), ("b", "no picture")), ("blur: noisy",))
    part = entry(state="done", seconds=12.0, result=result)
    assert state_text(part, 0.0) == "done · 12 s · 2 of 4 failed: a: no file"
    assert whole_text(part, 0.0).splitlines() == [
        "Small: 4 values",
        "done · 12 s · 2 of 4 failed: a: no file",
        "Output: /out",
        "b: no picture",
        "blur: noisy",
    ]
