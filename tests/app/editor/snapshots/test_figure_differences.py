"""Figures of two states side by side: which way they differ, by how much, in which words."""

import math

import pytest

from app.editor.snapshots.all_figures import NodeFigure
from app.editor.snapshots.figure_differences import figure_differences


def figure(value, unit="K", node="electronics", name="netd_system_K"):
    return NodeFigure(node, name, "NETD system", value, unit, "what it means")


def one(a, b):
    (row,) = figure_differences([] if a is None else [a], [] if b is None else [b])
    return row


@pytest.mark.parametrize(
    ("a", "b", "way", "text"),
    [
        (0.1, 0.125, "up", "▲ +25 %"),
        (0.125, 0.1, "down", "▼ −20 %"),
        (-2.0, -1.0, "up", "▲ +50 %"),
        (-1.0, -2.0, "down", "▼ −100 %"),
        (0.0, 0.25, "up", "▲ +250 mK"),  # no share of nothing
        (0.25, 0.25, "same", "="),
        (1.0, 1.0 + 1e-9, "same", "="),  # nothing that six digits show
        (1.0, 1.00002, "up", "▲ +0.002 %"),
        (1.0, 1.000005, "up", "▲ < 0.001 %"),
        (1.0, 0.998766, "down", "▼ −0.12 %"),
        (math.inf, math.inf, "same", "="),
        (math.nan, math.nan, "same", "="),
        (1.0, math.nan, "other", "≠"),
        (3, 4, "up", "▲ +33.3 %"),
    ],
)
def test_numbers(a, b, way, text):
    row = one(figure(a), figure(b))
    assert (row.way, row.text) == (way, text)
    assert row.differs is (way != "same")


def test_no_difference_is_by_colour_alone():
    texts = {one(figure(1.0), figure(b)).text[0] for b in (0.5, 1.0, 2.0, math.nan)}
    assert texts == {"▼", "=", "▲", "≠"}


def test_what_rounding_leaves_of_zero_is_no_difference():
    assert one(figure(1e-17, ""), figure(3e-17, "")).text == "="
    assert one(figure(1e-17, "W/m²/sr"), figure(3e-17, "W/m²/sr")).text == "▲ +200 %"


def test_to_infinity():
    row = one(figure(1.0), figure(math.inf))
    assert row.way == "up"
    assert row.text.startswith("▲ +inf")


def test_both_values_have_the_prefix_of_the_larger():
    row = one(figure(0.0005092, "W/m²/sr"), figure(0.001108, "W/m²/sr"))
    assert (row.shown_a, row.shown_b, row.unit) == ("0.5092", "1.108", "mW/m²/sr")
    assert row.about == "B − A = +598.8 µW/m²/sr"
    assert float(row.shown_a) * 1e-3 == pytest.approx(0.0005092, rel=5e-4)


def test_texts_and_truth_values():
    assert one(figure("photon", ""), figure("photon", "")).way == "same"
    assert one(figure("photon", ""), figure("amplifier", "")).text == "≠"
    row = one(figure(False, ""), figure(True, ""))
    assert (row.way, row.shown_a, row.shown_b) == ("other", "no", "yes")
    assert one(figure(1, ""), figure(True, "")).way == "other"


def test_other_units_are_not_subtracted():
    row = one(figure(1.0, "K"), figure(2.0, "W/m²/sr"))
    assert (row.way, row.text) == ("unit", "≠ unit")
    assert row.about == "A in K, B in W/m²/sr"


def test_what_only_one_has():
    row = one(figure(1.0), None)
    assert (row.way, row.shown_b, row.text) == ("only A", "—", "only A")
    row = one(figure(None), figure(1.0))
    assert (row.way, row.shown_a, row.text) == ("only B", "—", "only B")
    assert figure_differences([figure(None)], [figure(None)]) == ()


def test_order_and_partners():
    kept = [figure(1.0, node="a"), figure(1.0, node="gone"), figure(2.0, node="b")]
    now = [figure(2.0, node="b"), figure(3.0, node="a"), figure(4.0, node="b", name="other")]
    rows = figure_differences(kept, now)
    assert [(row.node, row.name, row.way) for row in rows] == [
        ("b", "netd_system_K", "same"),
        ("a", "netd_system_K", "up"),
        ("b", "other", "only B"),
        ("gone", "netd_system_K", "only A"),
    ]
