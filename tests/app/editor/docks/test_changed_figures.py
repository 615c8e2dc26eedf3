"""The figures that differ between a snapshot and now."""

import math

import pytest

from app.editor.docks.snapshots import changed_figures


@pytest.mark.parametrize(
    ("a", "b", "line"),
    [
        (0.1, 0.125, "100 mK → 125 mK"),
        (1.0, 1.0 + 1e-9, None),  # nothing that six digits show
        (1.0, 1.00002, "1 K → 1.00002 K"),
        (math.nan, math.nan, None),
        (None, 1.0, "— → 1 K"),
    ],
)
def test_figures_that_differ(a, b, line):
    one, other = ({("camera", "netd_K"): (value, "K")} for value in (a, b))
    lines, count = changed_figures(one, other)
    assert (lines, count) == ([] if line is None else [f"camera NETD: {line}"], 1)
