"""Noise through the eye's filters, by quadrature of mpmath and in limits that are known."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.acquisition.mrtd import eyeball_mtf, perceived_share

DISPLAY = {"magnification": 3.0, "luminance_cd_m2": 34.0}


def eye(u, luminance):
    pupil = -9.011 + 13.23 * math.exp(-math.log10(luminance / 3.4262590996) / 21.082)
    pupil = min(max(pupil, 2.0), 8.0)
    f0 = math.exp(3.663 - 0.0216 * pupil**2 * math.log(pupil))
    i0 = (0.7155 + 0.277 / math.sqrt(pupil)) ** 2
    return mpmath.exp(-((43.69 * u / f0) ** i0) - 0.375 * u**1.21 - 0.4441 * u**2)


def test_the_eyeball():
    u = np.array([0.0, 0.1, 0.5, 1.0, 2.0])
    made = eyeball_mtf(frequency_cyc_per_mrad=u, luminance_cd_m2=34.0)
    assert made[0] == 1.0
    assert (np.diff(made) < 0).all()
    np.testing.assert_allclose(made, [float(eye(value, 34.0)) for value in u], rtol=1e-12)


@pytest.mark.parametrize("frequency", [0.2, 1.0, 2.5])
def test_white_noise_by_mpmath(frequency):
    across, along = 2.0, 1.5
    made = perceived_share(
        frequency=[frequency], across_cyc_per_mrad=across, along_cyc_per_mrad=along, **DISPLAY
    )

    def channel(x):
        return mpmath.exp(-4.4 * mpmath.log(x / frequency) ** 2) * eye(x / 3.0, 34.0) ** 2

    inner = [0, min(frequency, across) / 2, min(frequency, across), across]
    x = mpmath.quad(channel, sorted(set(inner))) / across
    y = mpmath.quad(lambda v: eye(v / 3.0, 34.0) ** 2, [0, along]) / along
    assert made[0] == pytest.approx(float(x * y), rel=1e-5)  # the cusp of the eye at zero


def test_cells_of_a_spectrum_add():
    """Of a spectrum in four cells, the sum of the shares of each by itself."""
    power = np.array([[3.0, 1.0], [0.5, 2.0]])
    how = {"frequency": [0.7, 1.9], "across_cyc_per_mrad": 2.0, "along_cyc_per_mrad": 1.5}
    whole = perceived_share(**how, **DISPLAY, spectrum=power)
    parts = np.zeros(2)
    for place in np.ndindex(2, 2):
        one = np.zeros((2, 2))
        one[place] = power[place]
        parts += perceived_share(**how, **DISPLAY, spectrum=one) * power[place] / power.sum()
    np.testing.assert_allclose(whole, parts, rtol=1e-12)
    flat = perceived_share(**how, **DISPLAY, spectrum=np.ones((2, 2)))
    np.testing.assert_allclose(flat, perceived_share(**how, **DISPLAY), rtol=1e-5)


def test_what_is_refused():
    good = {"frequency": [1.0], "across_cyc_per_mrad": 2.0, "along_cyc_per_mrad": 2.0, **DISPLAY}
    for wrong in ({"frequency": [0.0]}, {"magnification": 0.0}, {"spectrum": np.zeros((2, 2))}):
        with pytest.raises(ParameterError, match=next(iter(wrong))):
            perceived_share(**{**good, **wrong})
