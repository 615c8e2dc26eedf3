"""Tables of MTF against scipy's PCHIP, and where they begin and end."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from core.errors import DataError
from core.physics.optics.measured_otf import (
    from_zero,
    radial_tabulated_mtf,
    tabulated_mtf,
    tabulated_ptf,
)

RNG = np.random.default_rng(7)
TABLES = {
    "two": ((0.0, 3.0), (1.0, 0.2)),
    "three": ((0.0, 1.0, 3.0), (1.0, 0.2, 0.3)),
    "flat": ((0.0, 1.0, 1.5, 3.0, 9.0), (1.0, 0.5, 0.5, 0.5, 0.0)),
    "ripple": (tuple(range(9)), tuple(1.0 - 0.1 * np.abs(np.sin(1.3 * np.arange(9.0))))),
    "random": (
        (0.0, *np.cumsum(RNG.uniform(0.01, 4, 60)).tolist()), (1.0, *RNG.uniform(0, 1, 60)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
def test_interpolates_as_pchip_does(name):
    frequencies, values = TABLES[name]
    f = np.linspace(0.0, frequencies[-1], 4001)
    got = tabulated_mtf(frequency=f, frequencies=frequencies, values=values)
    np.testing.assert_allclose(got, PchipInterpolator(frequencies, values)(f), atol=3e-15)
    assert got.min() >= min(values) - 1e-15
    assert got.max() <= max(values) + 1e-15
    np.testing.assert_array_equal(
        got, radial_tabulated_mtf(rho=-f, frequencies=frequencies, values=values)
    )
    at_knots = tabulated_mtf(
        frequency=np.array(frequencies), frequencies=frequencies, values=values
    )
    np.testing.assert_allclose(at_knots, values, atol=1e-15)


def test_nothing_is_beyond_the_last_point_and_rounding_does_not_count():
    last = 3.0
    f = np.array([last, last * (1 + 2e-16), last * (1 + 1e-9), 100.0, -100.0])
    got = tabulated_mtf(frequency=f, frequencies=(0.0, last), values=(1.0, 0.25))
    np.testing.assert_array_equal(got, [0.25, 0.25, 0, 0, 0])


def test_a_phase_is_odd():
    table = {"frequencies": (0.0, 1.0, 2.0), "values": (0.0, -0.5, -1.5)}
    f = np.linspace(0, 2, 51)
    f = np.concatenate([-f[:0:-1], f])
    got = tabulated_ptf(frequency=f, **table)
    np.testing.assert_array_equal(got, -got[::-1])
    np.testing.assert_allclose(got[50:], PchipInterpolator(*table.values())(f[50:]), atol=1e-15)
    assert got[50] == 0.0


@pytest.mark.parametrize(
    ("frequencies", "values", "options", "expected"),
    [
        ((0.0, 1.0), (0.9995, 0.4), {}, ((0.0, 1.0), (1.0, 0.4))),
        ((2.0, 3.0), (0.9, 0.4), {}, ((0.0, 2.0, 3.0), (1.0, 0.9, 0.4))),
        ((0.0, 1.0), (0.8, 0.4), {"normalised": True}, ((0.0, 1.0), (1.0, 0.5))),
    ],
)
def test_every_table_begins_with_1(frequencies, values, options, expected):
    assert from_zero(frequencies, values, at_zero=1.0, **options) == expected


@pytest.mark.parametrize(
    ("frequencies", "values", "options", "words"),
    [
        ((0.0, 1.0), (0.8, 0.4), {"at_zero": 1.0}, "0.8 at frequency 0; allowed: 1 within 0.001"),
        ((0.0, 1.0), (0.2, 0.4), {"at_zero": 0.0}, "0.2 at frequency 0; allowed: 0 within 0.001"),
        ((1.0, 2.0), (0.8, 0.4), {"at_zero": 1.0, "normalised": True}, "begins at frequency 1"),
        (
            (0.0, 2.0),
            (0.0, 0.4),
            {"at_zero": 1.0, "normalised": True},
            "so it cannot be normalised",
        ),
    ],
)
def test_what_is_not_1_there_is_refused(frequencies, values, options, words):
    with pytest.raises(DataError, match=words):
        from_zero(frequencies, values, **options)


@pytest.mark.parametrize(
    ("frequencies", "values"),
    [((0.0,), (1.0,)), ((0.5, 1.0), (1.0, 0.5)), ((0.0, 1.0), (1.0,)), ((0.0, 0.0), (1.0, 1.0))],
)
def test_no_table(frequencies, values):
    with pytest.raises(DataError, match="two or more frequencies that rise from 0"):
        tabulated_mtf(frequency=0.0, frequencies=frequencies, values=values)
