"""MRTD by hand, by simulated noise, in both directions, and in noise as the eye filters it."""

import math

import mpmath
import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.acquisition.mrtd import (
    eyeball_mtf,
    mdtd_K,
    mrtd_flir92_K,
    mrtd_ratches_K,
    mrtd_two_dimensional,
    perceived_share,
)
from core.physics.noise.noise_components import NoiseVariances

FREQUENCY = np.linspace(0.01, 3.9, 80)
MTF = 1 - FREQUENCY / 5
SCAN = {
    "frequency": FREQUENCY, "mtf": MTF, "snr_threshold": 2.5, "noise_bandwidth_cyc_per_mrad": 4.0,
    "detector_along_mrad": 0.125,
}  # fmt: skip
STARE = {
    "frequency": FREQUENCY, "mtf": MTF, "snr_threshold": 2.5, "across_cyc_per_mrad": 4.0,
    "along_cyc_per_mrad": 4.0, "direction": "horizontal",
}  # fmt: skip


def ratches(**changes):
    return mrtd_ratches_K(**{"netd_K": 0.2, **SCAN, **changes})


def flir92(**changes):
    return mrtd_flir92_K(**{"noise": NoiseVariances(tvh=0.04), **STARE, **changes})


def sum_of_sinc_squared(length, end):
    """∫ sinc² from 0 to `end`, by the middles of 20000 strips."""
    x = np.pi * length * (np.arange(20000) + 0.5) * end / 20000
    return float(np.sum((np.sin(x) / x) ** 2) * end / 20000)


class TestByHand:
    def test_inframetrics(self):
        """Serial scan, 8 to 12 µm, NETD 0.2 K, at 0.1 cycles/mrad; 30 frames/s, 0.2 s, SNR 2.25.

        MRTD = π²/(4√14)·SNR·NETD/H·√(Δy·v·f·Q/(Δf·N_os·F·t_E)).
        """
        # Mirror of 16 turns a second: v = 2π·16·1000 = 100531 mrad/s.
        v, mtf = 100530.9649, 0.66662868
        # Bars 1/(2·0.1) = 5 mrad wide. Noise up to Δf/v = 49152/100531 = 0.488924 cycles/mrad:
        # Q = ∫ sinc²(5ξ) dξ = 0.0957340 (half a period's 0.1 for noise without bound).
        q = sum_of_sinc_squared(5, 0.4889239852)
        assert q == pytest.approx(0.0957340, abs=1e-7)
        # Lines 30°/170 = 523.599/170 = 3.079993 mrad apart: that is Δy/N_os, with
        # N_os = 4.384615/3.079993 = 1.423580.
        # Under the root: 3.079993·100531·0.1·0.0957340/(49152·30·0.2) = 0.0100510.
        root = math.sqrt(3.0799928 * v * 0.1 * q / (49152 * 6))
        # π²/(4√14) = 9.869604/14.966630 = 0.659441.
        by_hand = 0.6594406 * 2.25 * 0.2 / mtf * root
        assert by_hand == pytest.approx(0.0446289, abs=1e-7)
        found = mrtd_ratches_K(
            frequency=[0.05, 0.1], mtf=[0.9, mtf], netd_K=0.2, snr_threshold=2.25,
            noise_bandwidth_cyc_per_mrad=0.4889239852, detector_along_mrad=4.384615385,
            overscan=1.423579752, frames=6,
        )  # fmt: skip
        assert found[1] == pytest.approx(by_hand, rel=1e-6)

    @pytest.mark.parametrize("direction", ["horizontal", "vertical"])
    def test_kodak(self, direction):
        """Staring, 3 to 5 µm, 25 µm/200 mm, at 1 cycle/mrad; SNR 2.5, 6 frames."""
        mtf = 0.7565931
        # Pitch 0.125 mrad: Nyquist 4 cycles/mrad. Bars 0.5 mrad wide and 3.5 mrad long.
        over_width = sum_of_sinc_squared(0.5, 4) / 4
        over_length = sum_of_sinc_squared(3.5, 4) / 4
        assert over_width == pytest.approx(0.2374848, abs=1e-7)  # about one over 4 samples
        assert over_length == pytest.approx(0.0354559, abs=1e-7)  # about one over 28
        # σ: tvh 0.177, vh 0.05, th 0.02, h 0.03, tv 0.04, v 0.06, t 0.07 K. Squares over 6
        # frames: tvh 0.031329/6 = 0.0052215, th 0.0004/6 = 0.0000666667, tv 0.0016/6 =
        # 0.000266667; fixed: vh 0.0025, h 0.0009, v 0.0036.
        sample = over_length * (0.0052215 + 0.0025)
        pattern = 0.0000666667 + 0.0009 if direction == "horizontal" else 0.000266667 + 0.0036
        left = math.sqrt(over_width * (sample + pattern))
        by_hand = 1.2337006 * 2.5 * left / mtf
        assert by_hand == pytest.approx(
            0.0699670 if direction == "horizontal" else 0.1278287, abs=2e-7
        )
        noise = {"vh": 0.0025, "th": 0.0004, "h": 0.0009, "tv": 0.0016, "v": 0.0036, "t": 0.0049}
        found = flir92(
            frequency=[0.5, 1.0], mtf=[0.9, mtf], noise=NoiseVariances(tvh=0.031329, **noise),
            direction=direction, frames=6,
        )  # fmt: skip
        assert found[1] == pytest.approx(by_hand, rel=1e-5)


@pytest.mark.parametrize("direction", ["horizontal", "vertical"])
def test_simulated_noise_of_seven_components(direction):
    """Bars of 12 × 84 samples less the gaps beside them, in noise drawn sample by sample."""
    random = np.random.default_rng(8)
    sigma = {"tvh": 3, "vh": 0.8, "v": 2, "h": 0.2, "t": 5, "tv": 4, "th": 0.4}
    frames, rows, columns, repeats = 5, 84, 24, 3000
    if direction == "vertical":
        rows, columns = columns, rows
        sigma = {"tvh": 3, "vh": 0.8, "v": 0.2, "h": 2, "t": 5, "tv": 0.4, "th": 4}
    differences = []
    for _ in range(repeats):
        cube = np.zeros((frames, rows, columns))
        for name, size in sigma.items():
            shape = [n if axis in name else 1 for axis, n in zip("tvh", cube.shape, strict=True)]
            cube += random.normal(0, size, shape)
        frame = cube.mean(axis=0)
        frame = frame if direction == "horizontal" else frame.T
        differences.append(frame[:, :12].mean() - frame[:, 12:].mean())
    # Noise of bar and of gap are independent but equal: half of the difference's variance is one's.
    one = np.std(differences) / math.sqrt(2)
    noise = NoiseVariances(**{name: size**2 for name, size in sigma.items()})
    found = flir92(
        frequency=[1 / 24, 1 / 12], mtf=[1, 1], noise=noise, snr_threshold=1, direction=direction,
        across_cyc_per_mrad=0.5, along_cyc_per_mrad=0.5, frames=frames,
    )[0]  # fmt: skip
    # Of 12 samples the average of the continuous noise leaves 2 % less variance than of points.
    assert found == pytest.approx(math.pi**2 / 8 * one, rel=0.04)


class TestLaws:
    @pytest.mark.parametrize("model", [ratches, flir92])
    def test_infinite_from_the_first_zero_on(self, model):
        """A detector of 0.4 mrad: zero at 2.5 cycles/mrad, and lobes of false resolution beyond."""
        frequency = np.arange(1, 160) * 0.025
        lobes = np.sin(0.4 * np.pi * frequency) / (0.4 * np.pi * frequency)
        for mtf in (lobes, np.where(frequency == 2.5, 0.0, np.abs(lobes))):
            found = model(frequency=frequency, mtf=mtf)
            assert np.isfinite(found[frequency < 2.499]).all()
            assert np.isinf(found[frequency >= 2.5]).all()
            assert (np.diff(found[frequency < 2.499]) > 0).all()

    def test_sampled_picture_ends_at_nyquist(self):
        frequency = np.array([1.0, 2.0, 2.000001, 2.5])
        settings = {"frequency": frequency, "mtf": np.full(4, 0.5), "across_cyc_per_mrad": 2.0}
        assert list(np.isinf(flir92(**settings))) == [False, False, True, True]
        assert np.isfinite(flir92(**settings, sampled=False)).all()

    def test_variance_estimated_below_zero_is_none(self):
        spoilt = NoiseVariances(tvh=0.04, vh=-1, h=-2)
        np.testing.assert_array_equal(flir92(noise=spoilt), flir92())


@pytest.mark.parametrize(
    ("model", "changes", "name"),
    [
        (ratches, {"frequency": FREQUENCY - 0.01}, "frequency"),
        (ratches, {"mtf": MTF[1:]}, "mtf"),
        (ratches, {"netd_K": -1}, "netd_K"),
        (ratches, {"snr_threshold": 0}, "snr_threshold"),
        (ratches, {"overscan": 0}, "overscan"),
        (ratches, {"frames": 0.9}, "frames"),
        (flir92, {"across_cyc_per_mrad": 0}, "cyc_per_mrad"),
    ],
)
def test_refused(model, changes, name):
    with pytest.raises(ParameterError, match=name):
        model(**changes)


# The one MRTD of both directions: powers in closed form, and curves of any shape.


class TestTwoDimensional:
    def test_root_of_both_frequencies(self):
        """Powers: f_h = T and f_v = √(T/2), so that f = T^(3/4)/2^(1/4)."""
        frequency, mrtd = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=FREQUENCY, vertical_K=2 * FREQUENCY**2
        )
        inside = (mrtd > 2 * 0.01**2) & (mrtd < 3.9)
        truth = mrtd**0.75 / 2**0.25
        np.testing.assert_allclose(frequency[inside], truth[inside], rtol=1e-9)

    def test_direction_that_ends_at_nyquist_stays_there(self):
        cut = np.where(FREQUENCY < 1, FREQUENCY, np.inf)
        frequency, mrtd = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=FREQUENCY, vertical_K=cut
        )
        last = FREQUENCY[FREQUENCY < 1][-1]
        assert frequency[-1] == pytest.approx(math.sqrt(FREQUENCY[-1] * last))
        assert mrtd[-1] == pytest.approx(FREQUENCY[-1])

    def test_nothing_resolved(self):
        found = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=FREQUENCY, vertical_K=np.full(80, np.inf)
        )
        assert [len(each) for each in found] == [0, 0]

    def test_without_noise_all_is_resolved_up_to_the_end(self):
        """One direction without noise is always at its end; both have an MRTD of zero to theirs."""
        nothing, cut = np.zeros(80), np.where(FREQUENCY < 1, 0.0, np.inf)
        frequency, mrtd = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=FREQUENCY, vertical_K=nothing
        )
        np.testing.assert_allclose(frequency, np.sqrt(mrtd * 3.9), rtol=1e-12)
        frequency, mrtd = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=nothing, vertical_K=cut
        )
        end = FREQUENCY[FREQUENCY < 1][-1]
        assert frequency == pytest.approx([0.01, math.sqrt(3.9 * end)])
        assert list(mrtd) == [0, 0]


# Noise through the eye's filters, by quadrature of mpmath and in limits that are known.


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


class TestColouredNoise:
    """Noise behind a single pole 1/(1 + (πf/4)²), white along: spectrum in cells of 1/12."""

    CELLS = 48
    POLE = np.pi / 4.0  # dwell time of one sample, Nyquist 4 cycles/mrad

    def spectrum(self):
        """Mean of the pole's power in each cell: the difference of its integral, an arc tangent."""
        edges = np.linspace(0, 4, self.CELLS + 1)
        return np.diff(np.arctan(self.POLE * edges)).reshape(1, -1)

    def over_width(self, frequency):
        """∫ sinc²(x/(2f))/(1 + (πx/4)²) dx over ∫ 1/(1 + (πx/4)²) dx, in 200000 strips."""
        x = (np.arange(200000) + 0.5) * 4 / 200000
        weight = 1 / (1 + (self.POLE * x) ** 2)
        return float(np.sum(np.sinc(0.5 / frequency * x) ** 2 * weight) / np.sum(weight))

    def test_ratches(self):
        found = ratches(spectrum=self.spectrum())
        for k in (3, 20, 60):
            share = self.over_width(FREQUENCY[k])
            left = math.sqrt(share * 0.125 * 2 * FREQUENCY[k] / 7)
            truth = math.pi**2 / 8 * 2.5 * 0.2 * left / MTF[k]
            assert found[k] == pytest.approx(truth, rel=1e-3)

    @pytest.mark.parametrize("direction", ["horizontal", "vertical"])
    def test_flir92(self, direction):
        """All temporal noise has the spectrum, fixed noise stays as it is: vh 0.1 K, white."""
        noise = NoiseVariances(tvh=0.03, tv=0.004, th=0.005, t=0.001, vh=0.01)
        spectrum = self.spectrum() if direction == "horizontal" else self.spectrum().T
        found = flir92(noise=noise, spectrum=spectrum, direction=direction, frames=5)
        for k in (3, 20, 60):
            f = FREQUENCY[k]
            width = sum_of_sinc_squared(0.5 / f, 4) / 4
            length = sum_of_sinc_squared(3.5 / f, 4) / 4
            if direction == "horizontal":
                share = self.over_width(f) * length
            else:
                share = width * self.over_width(f / 7)  # along the bar, of 3.5/f
            left = math.sqrt(0.04 / 5 * share + 0.01 * width * length)
            truth = math.pi**2 / 8 * 2.5 * left / MTF[k]
            assert found[k] == pytest.approx(truth, rel=1e-3)

    @pytest.mark.parametrize("wrong", [[1.0, 2.0], [[0.0, 0.0]], [[-1.0, 2.0]], [[np.nan]]])
    def test_refused(self, wrong):
        for model in (ratches, flir92):
            with pytest.raises(ParameterError, match="spectrum"):
                model(spectrum=wrong)


# MDTD by hand for a staring array, by blurring in space, and the laws that it must obey.

SIGMA = 0.1  # of a Gaussian blur, mrad
FREQUENCY_MDTD = np.arange(2001) * 0.005


def gaussian(sigma):
    return np.exp(-2 * np.pi**2 * sigma**2 * FREQUENCY_MDTD**2)


def mdtd(size, sigma=SIGMA, sigma_y=None, **changes):
    settings = {
        "size_mrad": size, "frequency": FREQUENCY_MDTD, "mtf_x": gaussian(sigma),
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
    found = mdtd(
        [2.0], frequency=np.arange(4001) * 0.02, mtf_x=np.ones(4001), mtf_y=np.ones(4001),
        noise=NoiseVariances(tvh=0.03, th=0.006, tv=0.003, t=0.001, vh=0.01),
        spectrum=np.diff(np.arctan(pole * edges)).reshape(1, -1),
    )[0]  # fmt: skip
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
        ({"frequency": -FREQUENCY_MDTD}, r"frequency\[1\] = -"),
        ({"mtf_y": gaussian(1)[1:]}, "mtf_y"),
        ({"frames": 0}, "frames"),
        ({"eye_limit_mrad": 0.0}, "eye_limit_mrad"),
    ],
)
def test_refused_of_mdtd(changes, name):
    with pytest.raises(ParameterError, match=name):
        mdtd([1.0], **changes)
