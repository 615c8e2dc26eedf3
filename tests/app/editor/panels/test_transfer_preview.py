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


def test_half_contrast_within_the_first_step_of_the_plot():
    sigma = 100.0
    x, _ = transfer_lines(passing(sensor("jitter_mtf", {"sigma_mrad": sigma})), "node", "mtf")
    half = math.sqrt(math.log(2) / 2) / (math.pi * sigma)  # 0.00187
    assert half < x.frequency[1]
    assert x.half == pytest.approx(half, rel=1e-8)


def test_the_negative_lobe_of_a_detector_stays_negative():
    params = {
        "detector_x_um": 600.0,
        "detector_y_um": 60.0,
        "focal_length_mm": 130.0,
        "fill_x": 0.95,
    }
    x, y = transfer_lines(passing(sensor("detector_mtf", params)), "node", "mtf")
    width = 600 / 130 * 0.95
    at = 1.5 / width
    assert np.interp(at, x.frequency, x.values) == pytest.approx(-2 / (3 * math.pi), abs=1e-4)
    assert y.values.min() > 0.9
    assert y.half is None
    assert x.half == pytest.approx(0.60335 / width, rel=1e-3)  # sinc is one half there


def test_an_aperture_is_shown_up_to_its_cutoff():
    x, y = transfer_lines(passing(sensor("exit_pupil_mtf", pupil={"radius": 75.0})), "node", "mtf")
    for line in (x, y):
        assert line.cutoff == pytest.approx(7.5, rel=1e-9)  # 7.5 cm over 10 µm
        assert line.frequency[-1] == pytest.approx(7.5, rel=1e-9)
        assert line.at_nyquist == pytest.approx(0.9171, abs=5e-5)
        ratio = line.frequency / 7.5
        disc = 2 / np.pi * (np.arccos(ratio) - ratio * np.sqrt(1 - ratio**2))
        np.testing.assert_allclose(line.values, disc, atol=1e-9)


def test_an_aperture_that_ends_below_nyquist_is_shown_up_to_nyquist():
    pupil = {"radius": 3.0, "size_x": 512, "size_y": 512}
    x, _ = transfer_lines(passing(sensor("exit_pupil_mtf", pupil=pupil)), "node", "mtf")
    assert x.cutoff == pytest.approx(0.3)
    assert x.frequency[-1] == pytest.approx(NYQUIST, rel=1e-5)
    np.testing.assert_allclose(x.values[x.frequency > 0.3], 0, atol=1e-12)


def test_the_raw_autocorrelation_has_the_pupil_s_own_frequencies():
    params = {"interpolation": "none"}
    x, y = transfer_lines(
        passing(sensor("exit_pupil_mtf", params, pupil={"radius": 75.0})), "node", "mtf"
    )
    step = 25.6 * 10 / 512 / 10  # cm, samples, µm
    for line in (x, y):
        np.testing.assert_allclose(np.diff(line.frequency), step, rtol=1e-9)
        ratio = np.minimum(line.frequency / 7.5, 1)
        disc = 2 / np.pi * (np.arccos(ratio) - ratio * np.sqrt(1 - ratio**2))
        np.testing.assert_allclose(line.values, disc, atol=5e-3)
        assert line.frequency[-1] >= 7.5
        assert line.at_nyquist == pytest.approx(0.9171, abs=5e-3)


def test_the_published_phase_of_charge_transfer():
    params = {"model": "published"}
    x, y = transfer_lines(passing(sensor("charge_eff_phase", params)), "node", "ptf")
    w = np.pi * x.frequency / x.nyquist
    np.testing.assert_allclose(x.values, -0.0064 * (w - np.sin(w)), atol=1e-9)  # eq. 4.58
    assert x.at_nyquist == pytest.approx(-0.0201, abs=5e-5)  # fig. 5.44
    assert not y.values.any()
    assert x.half is None


def test_turbidity_is_shown_down_to_where_light_is_scattered_aside():
    params = {"turbulence": "none", "turbidity": "moderate"}
    x, _ = transfer_lines(passing(sensor("atmosphere_mtf", params)), "node", "mtf")
    assert x.frequency[1] < 1e-4
    beyond = x.frequency > 0.001
    np.testing.assert_allclose(x.values[beyond], 0.975, rtol=1e-9)
    depth = -math.log(0.975)
    below = x.frequency[~beyond]
    expected = np.exp(-depth * (below / 0.001) ** 2)
    np.testing.assert_allclose(x.values[~beyond], expected, rtol=1e-9)
