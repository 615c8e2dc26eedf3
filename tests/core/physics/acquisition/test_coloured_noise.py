"""Thresholds in noise that filters have left a spectrum, against sums in fine strips."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.acquisition.eye import coloured_share
from core.physics.acquisition.mdtd import mdtd_K
from core.physics.acquisition.mrtd import mrtd_flir92_K, mrtd_ratches_K
from core.physics.noise.noise_components import NoiseVariances

FREQUENCY = np.linspace(0.01, 3.9, 80)
MTF = 1 - FREQUENCY / 5


def ratches(**changes):
    return mrtd_ratches_K(
        frequency=FREQUENCY, mtf=MTF, netd_K=0.2, snr_threshold=2.5,
        noise_bandwidth_cyc_per_mrad=4.0, detector_along_mrad=0.125, **changes,
    )  # fmt: skip


def flir92(noise=NoiseVariances(tvh=0.04), direction="horizontal", **changes):  # noqa: B008
    return mrtd_flir92_K(
        frequency=FREQUENCY, mtf=MTF, noise=noise, snr_threshold=2.5, across_cyc_per_mrad=4.0,
        along_cyc_per_mrad=4.0, direction=direction, **changes,
    )  # fmt: skip


def sum_of_sinc_squared(length, end):
    x = np.pi * length * (np.arange(20000) + 0.5) * end / 20000
    return float(np.sum((np.sin(x) / x) ** 2) * end / 20000)


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

    def test_white_is_a_spectrum_of_one_height(self):
        for model in (ratches, flir92):
            np.testing.assert_allclose(model(spectrum=np.full((3, 48), 7.0)), model(), rtol=1e-12)

    @pytest.mark.parametrize("wrong", [[1.0, 2.0], [[0.0, 0.0]], [[-1.0, 2.0]], [[np.nan]]])
    def test_refused(self, wrong):
        for model in (ratches, flir92):
            with pytest.raises(ParameterError, match="spectrum"):
                model(spectrum=wrong)


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

    @pytest.mark.parametrize("width", [12, 40])
    def test_noise_that_is_averaged(self, width):
        """Samples averaged by threes along x, as drawn, over rectangles of width × 12 of them."""
        drawn = np.random.default_rng(4).normal(size=(1200, 1202))
        noise = (drawn[:, :-2] + drawn[:, 1:-1] + drawn[:, 2:]) / 3
        blocks = noise[:, : 1200 // width * width].reshape(100, 12, -1, width).mean(axis=(1, 3))
        place = (np.arange(400) + 0.5) / 800  # cycles a sample
        power = ((1 + 2 * np.cos(2 * np.pi * place)) / 3) ** 2
        found = coloured_share(
            length_x_mrad=[width],
            length_y_mrad=[12.0],
            noise_bandwidth_x_cyc_per_mrad=0.5,
            noise_bandwidth_y_cyc_per_mrad=0.5,
            spectrum=power[np.newaxis],
        )
        assert found[0] == pytest.approx(blocks.var() / noise.var(), rel=0.06)

    def test_sides_of_other_shapes_are_refused(self):
        with pytest.raises(ParameterError, match="of one shape"):
            coloured_share(length_x_mrad=[1, 2], length_y_mrad=[1], **BANDS, spectrum=[[1.0]])


def test_mdtd():
    """A target of 2 mrad without blur: SNR·√(σ²·share/6 + σ_vh²·E_x·E_y)."""
    at = np.arange(4001) * 0.02
    spectrum = TestColouredNoise().spectrum()
    found = mdtd_K(
        size_mrad=[2.0],
        frequency=at,
        mtf_x=np.ones(4001),
        mtf_y=np.ones(4001),
        noise=NoiseVariances(tvh=0.03, th=0.006, tv=0.003, t=0.001, vh=0.01),
        snr_threshold=2.5,
        noise_bandwidth_x_cyc_per_mrad=4.0,
        noise_bandwidth_y_cyc_per_mrad=4.0,
        frames=6,
        spectrum=spectrum,
    )[0]
    one = sum_of_sinc_squared(2, 4) / 4
    share = TestColouredNoise().over_width(0.25) * one
    truth = 2.5 * math.sqrt(0.04 / 6 * share + 0.01 * one * one)
    # Of a square without blur the sum to 80 cycles/mrad leaves out 0.3 % on each side.
    assert found == pytest.approx(truth, rel=8e-3)


def test_mdtd_of_a_target_of_which_nothing_is_left():
    at = np.arange(101) * 0.02
    found = mdtd_K(
        size_mrad=[1.0, 2.0],
        frequency=at,
        mtf_x=np.zeros(101),
        mtf_y=np.ones(101),
        noise=NoiseVariances(tvh=0.03),
        snr_threshold=2.5,
        noise_bandwidth_x_cyc_per_mrad=1.0,
        noise_bandwidth_y_cyc_per_mrad=1.0,
        window="image",
    )
    assert np.isinf(found).all()
