"""Axes, ticks and short numbers of previews: what is written there reads back as the value."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.modules.preview import Axis, brief, electrons, kelvin, pair, round_step

SIZES = st.floats(1e-12, 1e12)


def read(text):
    """The number that a text states."""
    plain = text.replace("\N{MINUS SIGN}", "-").replace("10⁰", "1")
    mantissa, _, power = plain.partition("·10")
    digits = power.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    return float(mantissa) * 10.0 ** int(digits or 0)


@given(SIZES)
def test_round_steps(least):
    step = round_step(least)
    leading = step / 10 ** math.floor(math.log10(step * (1 + 1e-9)))
    assert min(abs(leading - one) for one in (1, 2, 5)) < 1e-9
    assert least * (1 - 1e-6) <= step < 2.5 * least * (1 + 1e-6)


def test_every_round_step():
    found = [round_step(least) for least in (0.09, 0.1, 0.11, 0.2, 0.21, 0.5, 0.51, 1.0, 1.01)]
    assert found == pytest.approx([0.1, 0.1, 0.2, 0.2, 0.5, 0.5, 1.0, 1.0, 2.0])


@given(st.floats(-1e6, 1e6), SIZES, st.integers(2, 12))
def test_ticks_are_round_places_all_over_the_axis(low, length, most):
    """Also of an axis that is upside down."""
    high = low + max(length, 1e-3 * abs(low))
    for axis in (Axis(low, high), Axis(high, low), Axis(low, high + 1.0, reach=high)):
        ticks = axis.ticks(most)
        values = [value for value, _ in ticks]
        slack = 1e-5 * (high - low)
        assert 1 <= len(ticks) <= most + 1
        assert len(ticks) >= (most - 1) // 2.5  # not the next longer step
        assert low - slack <= values[0]
        assert values[-1] <= high + slack
        step = round_step((high - low) / most)
        assert values[0] - low < step + slack
        assert high - values[-1] < step + slack
        assert np.diff(values) == pytest.approx(step, rel=1e-6)
        for value, text in ticks:
            wrong = abs(float(text.replace("\N{MINUS SIGN}", "-")) - value)
            assert wrong < 1e-5 * step + 1e-14 * abs(value)


@pytest.mark.parametrize(
    ("axis", "most", "texts"),
    [
        (Axis(0.0, 3e5), 3, ["0", "1e+05", "2e+05", "3e+05"]),
        (Axis(0.0, 3e4), 3, ["0", "10000", "20000", "30000"]),
        (Axis(0.0, 3e-5), 3, ["0", "0.00001", "0.00002", "0.00003"]),
        (Axis(0.01562, 0.01563), 2, ["0.01562", "0.015625", "0.01563"]),
        (Axis(-0.4, 0.4), 4, ["−0.4", "−0.2", "0", "0.2", "0.4"]),
        (Axis(0.1, 100.0, log=True), 4, ["10⁻¹", "10⁰", "10¹", "10²"]),
        (Axis(0.1, 100.0, log=True), 3, ["10⁻¹", "10¹"]),
        (Axis(0.11, 99.0, log=True), 1, ["10⁰", "10¹"]),
    ],
)
def test_ticks_in_words(axis, most, texts):
    assert [text for _, text in axis.ticks(most)] == texts


def test_shares_of_an_axis():
    assert Axis(2.0, 6.0).share([2.0, 3.0, 6.0, 8.0]) == pytest.approx([0.0, 0.25, 1.0, 1.5])
    shares = Axis(0.01, 100.0, log=True).share([0.01, 0.1, 1.0, 100.0, 0.0])
    assert shares[:4] == pytest.approx([0.0, 0.25, 0.5, 1.0])
    assert -20.0 < shares[4] < 0.0  # of nothing: far below, and a number


@given(SIZES, st.sampled_from([1, -1]), st.integers(2, 5))
def test_brief_numbers_have_so_many_digits(size, sign, digits):
    text = brief(sign * size, digits)
    assert abs(read(text) - sign * size) <= max(0.5001 * 10 ** (1 - digits) * size, 0.0)
    assert len(text) <= 5 + max(5, digits + 3)
    assert ("·10" in text) == (not 1e-3 <= size < 1e5)
    assert pair(size, size, digits) == brief(size, digits)


def test_units_grow_with_the_number():
    assert [electrons(n) for n in (9999.0, 1e4, 12340.0, -999400.0, 999900.0, 1e6, 2.5e7)] == [
        "9999 e⁻", "10 ke⁻", "12.3 ke⁻", "−999 ke⁻", "1000 ke⁻", "1 Me⁻", "25 Me⁻",
    ]  # fmt: skip
    assert [kelvin(t) for t in (0.0, 0.0999, 0.1, -0.05, -2.0)] == [
        "0 K", "99.9 mK", "0.1 K", "−50 mK", "−2 K",
    ]  # fmt: skip
    assert pair(1.0, 2.0) == "1 × 2"
    assert [brief(v) for v in (0.0, -0.0, math.inf, 1e5, 99999.0)] == [
        "0", "0", "inf", "1·10⁵", "99999",
    ]  # fmt: skip
