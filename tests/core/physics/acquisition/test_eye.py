"""What the eye averages of noise, and the contrast that it needs, against sums and formulas."""

import math

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf

from core.errors import ParameterError
from core.physics.acquisition.target_acquisition import (
    coloured_share,
    eye_contrast_threshold,
    frame_count,
    frames_integrated,
    spatial_share,
    system_contrast_threshold,
)


@pytest.mark.parametrize("turns", [1e-9, 9e-5, 1.1e-4, 0.03, 0.5, 2.4446, 17.3, 200.0])
def test_share_is_the_mean_of_sinc_squared(turns):
    """The integral of its definition, summed between the zeros of the sine in 30 digits."""
    with mpmath.workdps(30):
        bounds = [mpmath.mpf(turns) * k / (int(turns) + 1) for k in range(int(turns) + 2)]
        truth = float(mpmath.quad(lambda x: mpmath.sincpi(x) ** 2, bounds) / turns)
    found = spatial_share(length_mrad=turns / 0.4, noise_bandwidth_cyc_per_mrad=0.4)
    assert found == pytest.approx(truth, rel=1e-12)


def test_frames():
    assert frames_integrated(frame_rate_Hz=30, eye_integration_s=0.2) == pytest.approx(6)
    assert frames_integrated(frame_rate_Hz=2, eye_integration_s=0.2) == 1
    assert frame_count(2.5) == 2.5


# Contrast threshold of the eye against Barten's formula in 30 digits, and behind a sensor.


mp.dps = 30


def sensitivity(u, luminance, width):
    """As Barten 1990 has it: a·u·e^(−bu)·√(1 + c·e^(bu))."""
    u, luminance, width = mpf(u), mpf(luminance), mpf(width)
    size = 1 + 12 / (width * (1 + u / 3) ** 2)
    a = 540 * (1 + mpf("0.7") / luminance) ** mpf("-0.2") / size
    b = mpf("0.3") * (1 + 100 / luminance) ** mpf("0.15")
    return a * u * mp.exp(-b * u) * mp.sqrt(1 + mpf("0.06") * mp.exp(b * u))


@pytest.mark.parametrize("luminance", [0.01, 3.4, 100.0, 1000.0])
@pytest.mark.parametrize("width", [0.5, 10.0, 60.0])
def test_barten_to_full_precision(luminance, width):
    for u in (1e-6, 0.1, 1.0, 4.0, 17.3, 60.0):
        found = eye_contrast_threshold(
            frequency_cyc_per_deg=u, luminance_cd_m2=luminance, display_deg=width
        )
        assert found == pytest.approx(float(1 / sensitivity(u, luminance, width)), rel=1e-13)


def test_nothing_is_seen_at_zero_and_far_beyond_acuity():
    found = eye_contrast_threshold(
        frequency_cyc_per_deg=[0, 1e5], luminance_cd_m2=100, display_deg=10
    )
    assert np.isinf(found).all()


def test_behind_a_sensor():
    """At 1 cyc/mrad, magnified 5 times: 17.4532925/5 cyc/deg at the eye."""
    at_eye = 1000 * math.pi / 180 / 5
    eye = float(1 / sensitivity(at_eye, 30.0, 15.0))
    settings = {"frequency": 1.0, "magnification": 5.0}
    settings |= {"luminance_cd_m2": 30.0, "display_deg": 15.0}
    assert system_contrast_threshold(**settings, mtf=1.0) == pytest.approx(eye, rel=1e-12)
    assert system_contrast_threshold(**settings, mtf=-0.25) == pytest.approx(4 * eye, rel=1e-12)
    assert system_contrast_threshold(**settings, mtf=0.0) == np.inf
    # √(1 + (169.6·0.01)²) = √(1 + 2.876416) = 1.96886160
    noisy = system_contrast_threshold(**settings, mtf=1.0, relative_noise=0.01)
    assert noisy == pytest.approx(1.96886160 * eye, rel=1e-8)
    both = system_contrast_threshold(**settings, mtf=[[1.0], [0.5]], relative_noise=[0.0, 0.01, 1])
    assert both.shape == (2, 3)


SIDES = {"length_x_mrad": [0.0, 0.3, 2.0, 40.0], "length_y_mrad": [0.0, 1.0, 0.2, 40.0]}
BANDS = {"noise_bandwidth_x_cyc_per_mrad": 4.0, "noise_bandwidth_y_cyc_per_mrad": 1.5}


class TestShare:
    def test_of_a_spectrum_that_is_no_product(self):
        """Cells of 2 × 3, no row a multiple of the other, summed in 600 × 600 places."""
        power = np.array([[5.0, 1.0, 0.0], [2.0, 3.0, 4.0]])
        found = coloured_share(**SIDES, **BANDS, spectrum=power)
        x = (np.arange(6000) + 0.5) * 4 / 6000
        y = (np.arange(6000) + 0.5) * 1.5 / 6000
        for k in range(4):
            in_x = np.sinc(SIDES["length_x_mrad"][k] * x) ** 2
            in_y = np.sinc(SIDES["length_y_mrad"][k] * y) ** 2
            total = sum(
                power[i, j] * in_y[3000 * i : 3000 * (i + 1)].mean()
                * in_x[2000 * j : 2000 * (j + 1)].mean()
                for i in range(2)
                for j in range(3)
            )  # fmt: skip
            assert found[k] == pytest.approx(total / 15.0, rel=1e-5)

    def test_sides_of_other_shapes_are_refused(self):
        with pytest.raises(ParameterError, match="equal in shape"):
            coloured_share(length_x_mrad=[1, 2], length_y_mrad=[1], **BANDS, spectrum=[[1.0]])
