"""The bound on what snapshots hold: pictures of the oldest go, what is shared counts once."""

import math
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from app.editor.docks.snapshot_states import (
    KeptResults,
    KeptState,
    NodeFigure,
    Source,
    bounded,
    changed_figures,
    held_bytes,
)
from app.editor.viewers.pixels.grey_levels import spread_of
from app.editor.viewers.pixels.picture_facts import Axis, Facts
from app.editor.viewers.pixels.picture_layers import KeptPicture
from app.editor.viewers.plot.curves_query import CurvesQuery
from core.network.network import Network

FACTS = Facts("picture", 8, 8, "radiance", "W/m²/sr", Axis(0, 1, "column"), Axis(0, 1, "row"))
EACH = 8 * 8 * 4


def kept(samples):
    return KeptPicture("a.image", None, samples, FACTS, spread_of(samples))


def state(number, *arrays):
    pictures = {f"node{place}.image": kept(samples) for place, samples in enumerate(arrays)}
    results = KeptResults(Source(Network(), Path()), pictures, figures=())
    return KeptState(
        number, f"Snapshot {number}", datetime(2020, 1, 1), Network(), Network(), results
    )


def samples():
    return np.zeros((8, 8), np.float32)


def test_what_is_shared_counts_once():
    one, two = samples(), samples()
    assert held_bytes([state(1, one, one), state(2, one[2:, ::2]), state(3, two)]) == 2 * EACH


def test_the_oldest_lose_their_pictures_and_nothing_else():
    states = tuple(state(number, samples()) for number in (1, 2, 3, 4))
    left, dropped = bounded(states, 2 * EACH, 4)
    assert dropped == ("Snapshot 1", "Snapshot 2")
    assert [len(each.results.pictures) for each in left] == [0, 0, 1, 1]
    assert held_bytes(left) == 2 * EACH
    for before, after in zip(states, left, strict=True):
        assert after.network is before.network
        assert after.results.figures is before.results.figures


def test_the_one_that_is_compared_keeps_its_own():
    states = tuple(state(number, samples()) for number in (1, 2, 3))
    left, dropped = bounded(states, EACH, 1, {"node0.image"})
    assert dropped == ("Snapshot 2", "Snapshot 3")
    assert left[0].results.pictures


def test_of_the_one_that_is_compared_only_what_is_on_display_stays():
    alone = (state(1, samples(), samples(), samples()),)
    left, dropped = bounded(alone, EACH, 1, {"node1.image"})
    assert dropped == ("Snapshot 1",)
    assert list(left[0].results.pictures) == ["node1.image"]
    # What is on display stays, even beyond the bound: else it would be computed for ever.
    assert bounded(left, 0, 1, {"node1.image"}) == (left, ())


def test_of_curves_the_last_few_are_kept():
    results = KeptResults(Source(Network(), Path()))
    for angle in range(12):
        more = KeptResults(results.source, curves={CurvesQuery(float(angle)): None})
        results = results.joined(more)
    assert [query.angle_deg for query in results.curves] == [4, 5, 6, 7, 8, 9, 10, 11]


def test_within_the_bound_nothing_is_dropped():
    states = tuple(state(number, samples()) for number in (1, 2, 3))
    assert bounded(states, 3 * EACH, None) == (states, ())


@pytest.mark.parametrize(
    ("a", "b", "line"),
    [
        (0.1, 0.125, "100 mK → 125 mK"),
        (0.25, 0.25, None),
        (1.0, 1.0 + 1e-9, None),  # nothing that six digits show
        (1.0, 1.00002, "1 K → 1.00002 K"),
        (math.nan, math.nan, None),
        (1.0, math.nan, "1 K → nan K"),
        (None, 1.0, "— → 1 K"),
        (True, False, "yes → no"),
        ("day", "night", "day → night"),
    ],
)
def test_figures_that_differ(a, b, line):
    one, other = (NodeFigure("camera", "netd_K", "NETD", value, "K", "") for value in (a, b))
    lines, count = changed_figures([one], [other])
    assert (lines, count) == ((() if line is None else (f"camera NETD: {line}",)), 1)


def test_what_rounding_leaves_of_zero_is_no_difference():
    one, other = (NodeFigure("camera", "share", "share", value, "", "") for value in (1e-17, 3e-17))
    assert changed_figures([one], [other]) == ((), 1)
    assert changed_figures([one], [])[0] == ("camera share: 1e−17 → —",)
