"""The image quality equations against the reference and mpmath, edge responses by closed forms."""

import math

import mpmath
import numpy as np
import pytest
from scipy.special import ndtr

from core.errors import ParameterError
from core.physics.acquisition.giqe import (
    beyond_limits,
    edge_overshoot,
    edge_response,
    giqe_3,
    giqe_4,
    giqe_5,
    relative_edge_response,
    weighted_rer,
)
from reference_cases import CAMERA, reference_cases


@pytest.mark.parametrize("case", reference_cases("giqe", file=CAMERA))
def test_the_reference(case):
    given = {name: float(value) for name, value in case["inputs"].items()}
    assert giqe_4(**given) == pytest.approx(float(case["expected"]["giqe4"]), rel=1e-9)
    del given["overshoot"], given["noise_gain"]
    assert giqe_5(**given) == pytest.approx(float(case["expected"]["giqe5"]), rel=1e-9)


LOSSES = {  # by SNR and Q: the RER of every smear, the loss
    (50, 1): [(0.329, 0.00), (0.302, -0.03), (0.247, -0.11), (0.169, -0.33), (0.100, -0.87)],
    (50, 2): [(0.220, 0.00), (0.211, -0.03), (0.187, -0.12), (0.138, -0.43), (0.095, -0.97)],
    (5, 1): [(0.329, 0.00), (0.302, -0.05), (0.247, -0.19), (0.169, -0.51), (0.100, -1.19)],
    (5, 2): [(0.220, 0.00), (0.211, -0.04), (0.187, -0.17), (0.138, -0.56), (0.095, -1.20)],
}


@pytest.mark.parametrize(("snr", "q"), LOSSES)
def test_published_losses_of_niirs_by_smear(snr, q):
    rows = LOSSES[snr, q]
    across = rows[0][0]

    def niirs(along):
        rer = weighted_rer(rer_x=across, rer_y=along)
        return giqe_5(gsd_inch=20.8, rer=rer, snr=snr)

    for along, loss in rows:
        # RER to three digits and the loss to two
        assert niirs(along) - niirs(across) == pytest.approx(loss, abs=0.02)


@pytest.mark.parametrize(
    ("gsd", "rer", "snr", "height", "gain"),
    [(12, 0.9, 50, 1.0, 1.0), (5.3, 0.42, 11.5, 1.3, 2.7), (79.0, 1.2, 4.0, 1.1, 0.5)],
)
def test_by_mpmath(gsd, rer, snr, height, gain):
    with mpmath.workdps(30):
        log = mpmath.log10
        third = 11.81 + 3.32 * log(mpmath.mpf(rer) / gsd) - 1.48 * height - mpmath.mpf(gain) / snr
        a, b = (3.32, 1.559) if rer >= 0.9 else (3.16, 2.817)
        fourth = 10.251 - a * log(gsd) + b * log(rer) - 0.656 * height - 0.344 * gain / snr
        fifth = 9.57 - 3.32 * log(gsd) - 2 * log(rer) ** 4 - mpmath.mpf("1.8") / snr
        fifth += 3.32 * (1 - mpmath.exp(-mpmath.mpf("1.9") / snr)) * log(rer)
    all_of = {"gsd_inch": gsd, "rer": rer, "snr": snr}
    beside = {"overshoot": height, "noise_gain": gain}
    assert giqe_3(**all_of, **beside) == pytest.approx(float(third), rel=1e-13)
    assert giqe_4(**all_of, **beside) == pytest.approx(float(fourth), rel=1e-13)
    assert giqe_5(**all_of) == pytest.approx(float(fifth), rel=1e-13)


def test_limits_are_named():
    assert beyond_limits(gsd_inch=12.0, rer=0.9, overshoot=1.0, snr=50.0) == ()
    assert beyond_limits(gsd_inch=2.0, rer=0.9, overshoot=1.0, snr=279.0) == (
        "gsd_inch = 2 (3 to 80)",
        "snr = 279 (2 to 130)",
    )


@pytest.mark.parametrize(
    "wrong", [{"gsd_inch": 0.0}, {"rer": -1.0}, {"snr": 0.0}, {"overshoot": 0.0}]
)
def test_what_is_refused(wrong):
    with pytest.raises(ParameterError, match=next(iter(wrong))):
        giqe_4(**{"gsd_inch": 12.0, "rer": 0.9, "snr": 50.0, **wrong})


PLACES = np.array([-2.0, -0.5, 0.0, 0.25, 0.5, 1.25, 3.0])


@pytest.mark.parametrize("sigma", [0.2, 0.45, 1.7])
@pytest.mark.parametrize("sample", [0.02, 3.0])
def test_the_edge_behind_a_gaussian(sigma, sample):
    def mtf(xi):
        return np.exp(-2 * (np.pi * sigma * sample * xi) ** 2)

    made = edge_response(mtf=mtf, places_px=PLACES, sample_mrad=sample)
    np.testing.assert_allclose(made, ndtr(PLACES / sigma), atol=1e-12)
    rer = relative_edge_response(mtf=mtf, sample_mrad=sample)
    assert rer == pytest.approx(2 * ndtr(0.5 / sigma) - 1, rel=1e-12)
    assert edge_overshoot(mtf=mtf, sample_mrad=sample) == pytest.approx(
        ndtr(1.25 / sigma), abs=1e-12
    )


@pytest.mark.parametrize("width", [1.0, 1.6, 3.0])
def test_the_edge_behind_an_aperture(width):
    """A ramp as wide as the aperture."""

    def mtf(xi):
        return np.sinc(width * 0.1 * xi)

    made = edge_response(mtf=mtf, places_px=PLACES, sample_mrad=0.1)
    np.testing.assert_allclose(made, np.clip(0.5 + PLACES / width, 0, 1), atol=2e-4)


def test_a_sharpened_edge_overshoots():
    """Gaussian and its second derivative: H = (1 + k·ξ²)·exp(−2π²σ²ξ²)."""
    sigma, k = 0.5, 12.0

    def mtf(xi):
        return (1 + k * xi**2) * np.exp(-2 * (np.pi * sigma * xi) ** 2)

    places = np.arange(1.0, 3.01, 0.25)
    # −k/(4π²) times the second derivative of Φ(d/σ).
    bump = k / (4 * np.pi**2) * places / sigma**3
    bump *= np.exp(-((places / sigma) ** 2) / 2) / math.sqrt(2 * np.pi)
    expected = ndtr(places / sigma) + bump
    assert expected.max() > 1.02
    assert edge_overshoot(mtf=mtf, sample_mrad=1.0) == pytest.approx(expected.max(), rel=1e-10)
