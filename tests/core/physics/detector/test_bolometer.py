"""Microbolometers: scaling of NETD and a first-order lag, by hand."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from core.physics.detector.focal_plane_array import lag_weights, netd_noise_radiance, share_kept

SHEET = {
    "netd_K": 0.05, "reference_K": 300.0, "reference_sr": math.pi / 5, "lens_sr": math.pi / 5,
    "cut_on_um": 8.0, "cut_off_um": 14.0,
}  # fmt: skip


def slope(kelvin, low=8.0, high=14.0):
    """dL/dT of a band by Planck's law, W/m²/sr/K."""
    h, c, k = 6.62607015e-34, 299792458.0, 1.380649e-23

    def spectral(um):
        wave = um * 1e-6
        x = h * c / (wave * k * kelvin)
        return 2 * h * c**2 / wave**5 * x / kelvin * math.exp(x) / math.expm1(x) ** 2 * 1e-6

    return quad(spectral, low, high, epsrel=1e-11)[0]


def test_noise_is_netd_times_the_slope_at_the_reference():
    assert netd_noise_radiance(**SHEET) == pytest.approx(0.05 * slope(300.0), rel=1e-8)


@pytest.mark.parametrize(
    ("changed", "factor"),
    [
        ({"lens_sr": math.pi / (4 * 1.6**2 + 1)}, (4 * 1.6**2 + 1) / 5),
        ({"reference_sr": math.pi / 17}, 5 / 17),
        ({"lens_sr": 0.8 * math.pi / 5}, 1.25),
        ({"netd_K": 0.1}, 2.0),
    ],
)
def test_laws_of_scaling(changed, factor):
    """Kruse 2001, eq. 3.37: NETD goes as (4F² + 1)/(τ·dL/dT)."""
    found = netd_noise_radiance(**{**SHEET, **changed})
    assert found == pytest.approx(factor * netd_noise_radiance(**SHEET), rel=1e-12)


def test_the_lag_is_the_heat_balance_followed_step_by_step():
    """C·dx/dt = s − x at each frame's scene, integrated in small steps, read at the frame's end."""
    rate, constant, steps = 50.0, 0.012, 4000
    scene = np.random.default_rng(3).uniform(size=40)
    state, shown = scene[0], []
    for value in scene:
        for _ in range(steps):
            state += (value - state) / (rate * constant * steps)
        shown.append(state)
    weights = lag_weights(kept=share_kept(time_constant_s=constant, frame_rate_Hz=rate), most=64)
    count = len(weights)
    assert math.fsum(weights) == pytest.approx(1.0, abs=1e-15)
    for frame in range(count, 40):
        found = np.dot(weights, scene[frame - count + 1 : frame + 1][::-1])
        assert found == pytest.approx(shown[frame], abs=2e-4)


def test_a_long_lag_is_cut_and_still_adds_to_one():
    weights = lag_weights(kept=0.99, most=64)
    assert len(weights) == 64
    assert math.fsum(weights) == pytest.approx(1.0, abs=1e-14)
