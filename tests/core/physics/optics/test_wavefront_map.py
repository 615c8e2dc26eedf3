"""Where a wavefront map is known, and its units."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.optics.wavefront import known_wavefront, map_scale, wrapped_waves

Y, X = np.mgrid[-1:1:41j, -1:1:41j]
INSIDE = X**2 + Y**2 <= 0.81


@pytest.mark.parametrize(
    "waves", [X, Y, X * Y + 0.1 * X, Y * (3 * (X**2 + Y**2) - 2)], ids=["x", "y", "xy", "coma"]
)
def test_zeros_from_the_border_on_are_outside_and_lines_of_zeros_within_are_not(waves):
    """The map of a disc is 0 along a whole row or column where the wavefront changes its sign."""
    known = np.isfinite(known_wavefront(np.where(INSIDE, waves, 0.0)))
    assert (known & ~INSIDE).sum() == 0
    lost = INSIDE & ~known
    assert lost.sum() <= 2  # the ends of the line, which look like the outside


def test_nan_is_outside_and_zeros_then_are_not():
    values = np.where(INSIDE, 0.0, np.nan)
    np.testing.assert_array_equal(np.isfinite(known_wavefront(values)), INSIDE)


def test_without_an_empty_border_all_is_known():
    assert np.isfinite(known_wavefront(X * Y + 1.5)).all()


def test_units():
    """Half a wave of 0.633 µm is π rad, 0.3165 µm and 316.5 nm."""
    for unit, number in (("waves", 0.5), ("rad", np.pi), ("um", 0.3165), ("nm", 316.5)):
        factor, own = map_scale(unit, 0.633)
        assert factor * number * own / 0.633 == pytest.approx(0.5)
    assert map_scale("waves", None) == (1.0, None)
    assert map_scale("um", None) == (1.0, 1.0)
    with pytest.raises(ParameterError, match="waves, rad, um, nm"):
        map_scale("mm", None)


def test_complex_samples_are_wrapped():
    amplitude = 0.3 * np.exp(2j * np.pi * np.array([0.1, -0.4, 0.7]))
    np.testing.assert_allclose(wrapped_waves(amplitude), [0.1, -0.4, -0.3])
