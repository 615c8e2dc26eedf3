"""What the list says of a run, and how long it says a run still takes."""

from pathlib import Path

import pytest

from app.editor.docks.runs import Run, duration, state_text, whole_text
from app.run.job import Job, Result


@pytest.fixture
def run(qapp):
    return Run("Small: 4 values", Job("sweep", "", Path(), None, Path("/out")))


def test_durations():
    said = {0.04: "0.0 s", 9.96: "10 s", 3599: "1 h 0 min", 7790: "2 h 10 min"}
    assert {seconds: duration(seconds) for seconds in said} == said


def test_time_left_is_counted_from_the_first_step(run):
    """Half of it in 10 s, after 5 s of loading: 10 s are left."""
    run.state, run.begun, run.first = "running", 100.0, (105.0, 0.0)
    run.share, run.doing = 0.5, "blur"
    assert run.left_s(115.0) == pytest.approx(10.0)
    assert state_text(run, 115.0) == "50 % · 10 s left · blur"


def test_ends_are_said_in_one_line(run):
    assert state_text(run, 0.0) == "waiting"
    run.state, run.text = "failed", "blur: no such value"
    assert state_text(run, 0.0) == "failed: blur: no such value"
    run.state, run.seconds = "done", 12.0
    run.result = Result(4, (("a", "no file"), ("b", "no picture")), ("blur: noisy",))
    assert whole_text(run, 0.0).splitlines() == [
        "Small: 4 values",
        "done · 12 s · 2 of 4 runs failed; the first, a: no file",
        "Output: /out",
        "b: no picture",
        "blur: noisy",
    ]
