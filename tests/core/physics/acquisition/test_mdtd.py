"""MDTD by hand for a staring array, by blurring in space, and the laws that it must obey."""

import math

import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.acquisition.mrtd import mdtd_K
from core.physics.noise.noise_components import NoiseVariances

SIGMA = 0.1  # of a Gaussian blur, mrad
FREQUENCY = np.arange(2001) * 0.005


def gaussian(sigma):
    return np.exp(-2 * np.pi**2 * sigma**2 * FREQUENCY**2)


def mdtd(size, sigma=SIGMA, sigma_y=None, **changes):
    settings = {
        "size_mrad": size, "frequency": FREQUENCY, "mtf_x": gaussian(sigma),
        "mtf_y": gaussian(sigma if sigma_y is None else sigma_y),
        "noise": NoiseVariances(tvh=0.031329), "snr_threshold": 2.5,
        "noise_bandwidth_x_cyc_per_mrad": 4.0, "noise_bandwidth_y_cyc_per_mrad": 4.0, "frames": 6,
    }  # fmt: skip
    return mdtd_K(**{**settings, **changes})


def blurred_mean(width, window, sigma):
    """Mean over the window of a blurred bar of height 1, from the error function, in strips."""
    places = ((np.arange(4000) + 0.5) / 4000 - 0.5) * window
    ends = [math.sqrt(0.5) / sigma * (places + side * width / 2) for side in (1, -1)]
    upper, lower = (np.array([math.erf(x) for x in each]) for each in ends)
    return float(np.mean(upper - lower) / 2)


def sum_of_sinc_squared(length, end):
    x = np.pi * length * (np.arange(20000) + 0.5) * end / 20000
    return float(np.sum((np.sin(x) / x) ** 2) * end / 20000)


def test_inframetrics_by_hand():
    """Serial scan, 8 to 12 µm: 30°/170 = 3.079993 mrad a sample, NETD 0.2 K, SNR 2.25, 6 frames.

    Optics and aberration as one Gaussian of 0.5 mrad, detector 600 µm/130 mm·0.95 = 4.384615 mrad;
    a target of 20 m at 402 m, 49.751244 mrad wide, and Nyquist at 0.5/3.079993 = 0.162338.
    """
    # Of the target's height its own square keeps 1 − E|x|/W in each direction, x where the blur
    # puts the light. Of the detector's half width a = 2.1923077 and σ = 0.5, which it far exceeds,
    # E|x| = a/2 + σ²/(2a) = 1.0961538 + 0.25/4.3846154 = 1.0961538 + 0.0570175 = 1.1531714 mrad;
    # over 49.751244: 0.0231787, so 0.9768213; for both directions squared 0.9541799.
    # Noise: N = B·W = 0.1623379·49.751244 = 8.0765128. E = 1/(2N) − 1/(2π²N²) − sin(2πN)/(4π³N³)
    # + cos(2πN)/(4π⁴N⁴) = 0.0619079 − 0.0007766 − 0.0000071 + 0.0000005 = 0.0611247 for each.
    share = sum_of_sinc_squared(49.751244, 0.1623379) / 0.1623379
    assert share == pytest.approx(0.0611247, abs=2e-7)
    # 2.25·0.2/√6 = 0.1837117 K; times 0.0611247 (the root of both), over 0.9541799.
    by_hand = 0.1837117 * 0.0611247 / 0.9541799
    assert by_hand == pytest.approx(0.0117686, abs=1e-7)
    frequency = np.arange(6001) * 0.0025
    transfer = np.exp(-2 * np.pi**2 * 0.25 * frequency**2) * np.sinc(4.384615 * frequency)
    found = mdtd_K(
        size_mrad=[49.751244],
        frequency=frequency,
        mtf_x=transfer,
        mtf_y=transfer,
        noise=NoiseVariances(tvh=0.04),
        snr_threshold=2.25,
        noise_bandwidth_x_cyc_per_mrad=0.1623379,
        noise_bandwidth_y_cyc_per_mrad=0.1623379,
        frames=6,
    )[0]
    assert found == pytest.approx(by_hand, rel=5e-6)


def test_components_of_noise():
    """Columns are averaged across alone, rows along alone, frames over time if they change."""
    noise = NoiseVariances(tvh=0.09, vh=0.04, v=0.0016, h=0.0009, t=5, tv=0.0064, th=0.0049)
    share = sum_of_sinc_squared(2, 4) / 4
    across, along = share, sum_of_sinc_squared(2, 1) / 1
    left = across * along * (0.09 / 6 + 0.04)
    left += across * (0.0049 / 6 + 0.0009) + along * (0.0064 / 6 + 0.0016)
    truth = 2.5 * math.sqrt(left) / (blurred_mean(2, 2, 0.1) * blurred_mean(2, 2, 0.3))
    found = mdtd([2.0], sigma_y=0.3, noise=noise, noise_bandwidth_y_cyc_per_mrad=1.0)
    assert found[0] == pytest.approx(truth, rel=1e-6)


def test_window_of_the_image():
    """A Gaussian's equivalent width is 2·√π·σ; of a point, its mean over that is the blur's."""
    found = mdtd([0.002], sigma=1.0, window="image")[0]
    width = 2 * math.sqrt(math.pi)
    share = sum_of_sinc_squared(width, 4) / 4
    truth = 0.180650 * share / blurred_mean(0.002, width, 1.0) ** 2
    assert found == pytest.approx(truth, rel=1e-5)
    # Where the blur covers 28 samples, one that averages over the target alone sees far less.
    assert mdtd([0.002], sigma=1.0)[0] > 10 * found


@pytest.mark.parametrize("window", ["target", "image"])
def test_nothing_left_of_the_target(window):
    assert np.isinf(mdtd([1.0, 2.0], mtf_x=np.zeros(2001), window=window)).all()


def test_a_spectrum_of_all_temporal_noise():
    """A pole across, white along, without blur: SNR·√(σ²·share/6 + σ_vh²·E_x·E_y), 2 mrad."""
    pole, edges = np.pi / 4, np.linspace(0, 4, 49)
    found = mdtd_K(
        size_mrad=[2.0],
        frequency=np.arange(4001) * 0.02,
        mtf_x=np.ones(4001),
        mtf_y=np.ones(4001),
        noise=NoiseVariances(tvh=0.03, th=0.006, tv=0.003, t=0.001, vh=0.01),
        snr_threshold=2.5,
        noise_bandwidth_x_cyc_per_mrad=4.0,
        noise_bandwidth_y_cyc_per_mrad=4.0,
        frames=6,
        spectrum=np.diff(np.arctan(pole * edges)).reshape(1, -1),
    )[0]
    x = (np.arange(200000) + 0.5) * 4 / 200000
    weight = 1 / (1 + (pole * x) ** 2)
    one = sum_of_sinc_squared(2, 4) / 4
    share = np.sum(np.sinc(2 * x) ** 2 * weight) / np.sum(weight) * one
    truth = 2.5 * math.sqrt(0.04 / 6 * share + 0.01 * one * one)
    # Of a square without blur the sum to 80 cycles/mrad leaves out 0.3 % on each side.
    assert found == pytest.approx(truth, rel=8e-3)


@pytest.mark.parametrize(
    ("changes", "name"),
    [
        ({"size_mrad": [0.0]}, "size_mrad"),
        ({"size_mrad": [101.0]}, "half the inverse of the frequency step"),
        ({"frequency": -FREQUENCY}, r"frequency\[1\] = -"),
        ({"mtf_y": gaussian(1)[1:]}, "mtf_y"),
        ({"frames": 0}, "frames"),
        ({"eye_limit_mrad": 0.0}, "eye_limit_mrad"),
    ],
)
def test_refused(changes, name):
    with pytest.raises(ParameterError, match=name):
        mdtd([1.0], **changes)
