"""Contrast threshold of the eye against Barten's formula in 30 digits, and behind a sensor."""

from __future__ import annotations

import math

import numpy as np
import pytest
from mpmath import mp, mpf

from core.errors import ParameterError
from core.physics.acquisition.eye import eye_contrast_threshold, system_contrast_threshold

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


# L = 100 cd/m², w = 10°, u = 4: (1.007)^−0.2 = 0.9986059; (1 + 4/3)² = 5.4444444, so
# 1 + 12/54.444444 = 1.2204082; a = 540·0.9986059/1.2204082 = 441.8597
# b = 0.3·2^0.15 = 0.3·1.1095695 = 0.3328708; e^(−4b) = e^−1.3314834 = 0.2640853
# 1 + 0.06/0.2640853 = 1.2271994, root 1.1077903; 441.8597·4·0.2640853·1.1077903 = 517.064
def test_sensitivity_near_its_peak_by_hand():
    found = eye_contrast_threshold(frequency_cyc_per_deg=4, luminance_cd_m2=100, display_deg=10)
    assert 1 / found == pytest.approx(517.064, rel=2e-6)


def test_nothing_is_seen_at_zero_and_far_beyond_acuity():
    found = eye_contrast_threshold(
        frequency_cyc_per_deg=[0, 1e5], luminance_cd_m2=100, display_deg=10
    )
    assert np.isinf(found).all()


def test_behind_a_sensor():
    """At 1 cyc/mrad, magnified 5 times: 17.4532925/5 cyc/deg at the eye."""
    at_eye = 1000 * math.pi / 180 / 5
    eye = float(1 / sensitivity(at_eye, 30.0, 15.0))
    settings = {
        "frequency": 1.0,
        "luminance_cd_m2": 30.0,
        "display_deg": 15.0,
        "magnification": 5.0,
    }
    assert system_contrast_threshold(**settings, mtf=1.0) == pytest.approx(eye, rel=1e-12)
    assert system_contrast_threshold(**settings, mtf=-0.25) == pytest.approx(4 * eye, rel=1e-12)
    assert system_contrast_threshold(**settings, mtf=0.0) == np.inf
    # √(1 + (169.6·0.01)²) = √(1 + 2.876416) = 1.96886160
    noisy = system_contrast_threshold(**settings, mtf=1.0, relative_noise=0.01)
    assert noisy == pytest.approx(1.96886160 * eye, rel=1e-8)
    both = system_contrast_threshold(**settings, mtf=[[1.0], [0.5]], relative_noise=[0.0, 0.01, 1])
    assert both.shape == (2, 3)


@pytest.mark.parametrize(
    ("wrong", "named"),
    [
        ({"frequency": -1.0}, "frequency"),
        ({"mtf": np.nan}, "mtf"),
        ({"luminance_cd_m2": 0.0}, "luminance_cd_m2"),
        ({"display_deg": 0.0}, "display_deg"),
        ({"magnification": 0.0}, "magnification"),
        ({"relative_noise": -0.1}, "relative_noise"),
        ({"mtf": np.ones(2), "frequency": np.ones(3)}, "broadcast"),
        ({"mtf": np.ones(2), "frequency": np.ones(2), "display_deg": np.ones(3)}, "broadcast"),
    ],
)
def test_what_is_out_of_range_is_refused_by_name(wrong, named):
    good = {
        "frequency": 1.0,
        "mtf": 1.0,
        "luminance_cd_m2": 30.0,
        "display_deg": 15.0,
        "magnification": 5.0,
    }
    with pytest.raises(ParameterError, match=named):
        system_contrast_threshold(**{**good, **wrong})
