"""What the list says of a run, without Qt."""

from __future__ import annotations

import math

from app.editor.runs.run_queue import Entry

_MINUTE, _HOUR = 60, 3600


def duration(seconds: float) -> str:
    """A time in words, as exact as one can use: ``0.8 s``, ``45 s``, ``3 min``, ``2 h 10 min``."""
    if seconds < 9.95:
        return f"{seconds:.1f} s"
    if seconds < _MINUTE:
        return f"{math.ceil(seconds)} s"
    if seconds < _HOUR:
        return f"{math.ceil(seconds / _MINUTE)} min"
    hours, minutes = divmod(math.ceil(seconds / _MINUTE), 60)
    return f"{hours} h {minutes} min" if minutes else f"{hours} h"


def state_text(entry: Entry, now: float) -> str:
    """The state of a run in a line."""
    if entry.state == "running":
        parts = [f"{100 * entry.share:.0f} %"]
        left = entry.left_s(now)
        if left is not None:
            parts.append(f"{duration(max(1.0, round(left)))} left")
        return " · ".join([*parts, *filter(None, [entry.doing])])
    if entry.state == "failed":
        return f"failed: {entry.text}"
    if entry.state == "done":
        return " · ".join(filter(None, ["done", duration(entry.seconds), failures_text(entry)]))
    return entry.state


def failures_text(entry: Entry) -> str:
    """How many of several runs could not be made, and why the first of them; empty where all."""
    result = entry.result
    if result is None or not result.failures:
        return ""
    name, why = result.failures[0]
    return f"{len(result.failures)} of {result.runs} failed: {name}: {why}"


def whole_text(entry: Entry, now: float) -> str:
    """All there is to say of a run, in lines."""
    lines = [entry.title, state_text(entry, now), f"Output: {entry.job.output}"]
    if entry.result is not None:
        lines += [f"{name}: {why}" for name, why in entry.result.failures[1:10]]
        lines += entry.result.warnings[:10]
    return "\n".join(lines)
