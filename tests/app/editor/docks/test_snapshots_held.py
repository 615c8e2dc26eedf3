"""The bound on what snapshots hold: pictures of the oldest go, what is shared counts once."""

import math
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from app.editor.docks.snapshots import (
    Snapshot,
    Source,
    changed_figures,
    drop_pictures,
    held_bytes,
)
from app.editor.viewers.pixels.picture_facts import Axis, Facts
from app.editor.viewers.pixels.picture_query import KeptPicture
from core.network.network import Network

FACTS = Facts("picture", 8, 8, "radiance", "W/m²/sr", Axis(0, 1, "column"), Axis(0, 1, "row"))
EACH = 8 * 8 * 4


def kept(samples):
    return KeptPicture("a.image", None, samples, FACTS)


def state(number, *arrays):
    made = Snapshot(
        number, f"Snapshot {number}", datetime(2020, 1, 1), Network(), Source(Network(), Path())
    )
    made.pictures = {f"node{place}.image": kept(samples) for place, samples in enumerate(arrays)}
    return made


def samples():
    return np.zeros((8, 8), np.float32)


def test_what_is_shared_counts_once():
    one, two = samples(), samples()
    assert held_bytes([state(1, one, one), state(2, one[2:, ::2]), state(3, two)]) == 2 * EACH


def test_the_oldest_lose_their_pictures():
    states = [state(number, samples()) for number in (1, 2, 3, 4)]
    assert drop_pictures(states, 4 * EACH, None) == []
    assert drop_pictures(states, 2 * EACH, states[3]) == ["Snapshot 1", "Snapshot 2"]
    assert [len(each.pictures) for each in states] == [0, 0, 1, 1]


def test_the_one_that_is_compared_keeps_what_is_on_display():
    states = [state(1, samples(), samples()), state(2, samples()), state(3, samples())]
    dropped = drop_pictures(states, EACH, states[0], {"node1.image"})
    assert dropped == ["Snapshot 2", "Snapshot 3", "Snapshot 1"]
    assert list(states[0].pictures) == ["node1.image"]
    # What is on display stays, even beyond the bound: else it would be computed for ever.
    assert drop_pictures(states, 0, states[0], {"node1.image"}) == []


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
