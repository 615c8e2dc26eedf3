"""What the eye's averaging leaves of noise, against sums, series and noise that is averaged."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.acquisition.eye import frame_count, frames_integrated, spatial_share


@pytest.mark.parametrize("turns", [1e-9, 9e-5, 1.1e-4, 0.03, 0.5, 2.4446, 17.3, 800.0])
def test_share_is_the_mean_of_sinc_squared(turns):
    """The integral of its definition, summed between the zeros of the sine in 30 digits."""
    with mpmath.workdps(30):
        bounds = [mpmath.mpf(turns) * k / (int(turns) + 1) for k in range(int(turns) + 2)]
        truth = float(mpmath.quad(lambda x: mpmath.sincpi(x) ** 2, bounds) / turns)
    found = spatial_share(length_mrad=turns / 0.4, noise_bandwidth_cyc_per_mrad=0.4)
    assert found == pytest.approx(truth, rel=1e-12)


def test_share_of_a_long_length_is_one_over_its_samples():
    found = spatial_share(length_mrad=[0, 1e4, 1e308], noise_bandwidth_cyc_per_mrad=5)
    assert found[0] == 1
    assert found[1] == pytest.approx(1 / 1e5, rel=1e-5)
    assert 0 <= found[2] < 1e-300


@pytest.mark.parametrize("samples", [1, 2, 7])
def test_noise_that_is_averaged(samples):
    """White noise of independent samples, drawn 16 times as fine, averaged over windows."""
    fine, count = 16, 1 << 16
    noise = np.random.default_rng(3).normal(size=count)
    spectrum = np.zeros(count * fine // 2 + 1, complex)
    spectrum[: count // 2] = np.fft.rfft(noise)[: count // 2]
    finer = np.fft.irfft(spectrum) * fine
    window = samples * fine
    sums = np.cumsum(np.concatenate([[0], finer]))
    means = (sums[window:] - sums[:-window]) / window
    left = means.var() / noise.var()
    found = spatial_share(length_mrad=samples * 0.2, noise_bandwidth_cyc_per_mrad=0.5 / 0.2)
    assert found == pytest.approx(left, rel=0.02)


def test_frames():
    assert frames_integrated(frame_rate_Hz=30, eye_integration_s=0.2) == pytest.approx(6)
    assert frames_integrated(frame_rate_Hz=2, eye_integration_s=0.2) == 1
    assert frame_count(2.5) == 2.5


@pytest.mark.parametrize(
    "call",
    [
        lambda: spatial_share(length_mrad=-1, noise_bandwidth_cyc_per_mrad=1),
        lambda: spatial_share(length_mrad=[1, math.nan], noise_bandwidth_cyc_per_mrad=1),
        lambda: spatial_share(length_mrad=1, noise_bandwidth_cyc_per_mrad=0),
        lambda: frames_integrated(frame_rate_Hz=0, eye_integration_s=0.2),
        lambda: frames_integrated(frame_rate_Hz=30, eye_integration_s=math.inf),
        lambda: frame_count(0.5),
    ],
)
def test_refused(call):
    with pytest.raises(ParameterError, match="is not allowed"):
        call()
