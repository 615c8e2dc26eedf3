"""MTF and PTF along both axes, against formulas and figures that come from elsewhere."""

import math

import numpy as np
import pytest

from app.editor.panels.transfer_preview import transfer_lines
from preview_hands import passing, sensor

NYQUIST = 0.488924  # of 30° and 512 samples, fig. 4.3


def test_jitter_is_a_gaussian_up_to_nyquist():
    sigma = 0.6
    x, y = transfer_lines(passing(sensor("jitter_mtf", {"sigma_mrad": sigma})), "node", "mtf")
    for line in (x, y):
        assert line.frequency[0] == 0
        assert line.nyquist == pytest.approx(NYQUIST, abs=5e-7)
        assert line.frequency[-1] == pytest.approx(line.nyquist)
        expected = np.exp(-2 * np.pi**2 * sigma**2 * line.frequency**2)
        np.testing.assert_allclose(line.values, expected, rtol=1e-12)
        assert line.at_nyquist == pytest.approx(
            math.exp(-2 * math.pi**2 * (sigma * NYQUIST) ** 2), 1e-5
        )
        assert line.half == pytest.approx(math.sqrt(math.log(2) / 2) / (math.pi * sigma), rel=1e-8)
        assert line.cutoff is None


def test_an_aperture_is_shown_up_to_its_cutoff():
    x, y = transfer_lines(passing(sensor("exit_pupil_mtf", pupil={"radius": 75.0})), "node", "mtf")
    for line in (x, y):
        assert line.cutoff == pytest.approx(7.5, rel=1e-9)  # 7.5 cm over 10 µm
        assert line.frequency[-1] == pytest.approx(7.5, rel=1e-9)
        assert line.at_nyquist == pytest.approx(0.9171, abs=5e-5)
        ratio = line.frequency / 7.5
        disc = 2 / np.pi * (np.arccos(ratio) - ratio * np.sqrt(1 - ratio**2))
        np.testing.assert_allclose(line.values, disc, atol=1e-9)
