"""The well and the noises on the panel of Focal Plane, against the reference's camera."""

import numpy as np
import pytest
from PySide6.QtGui import QColor, QImage

from app.editor.panels.illustrations.focal_plane_illustration import ElectronsQuery
from app.editor.theme import DARK
from illustration_hands import answer, sensor, told

EXPECTED = {  # camera_values.json, camera-shared-0
    "signal_e": 453078.91635770707839, "well_fill_percent": 6.472555947967243977,
    "shot_noise_e": 673.11136995129348237, "netd_K": 0.045923803888498956611,
}  # fmt: skip
SCENE = {
    "kind": "uniform", "width": 16, "height": 12, "temperature_K": 293.15,
    "cut_on_um": 3.7, "cut_off_um": 4.8, "fov_x_deg": 1.0, "fov_y_deg": 1.0,
}  # fmt: skip
INIT = {
    "detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 100, "f_number": 4,
    "fill_x": 0.95, "fill_y": 0.95, "platform": "array",
}  # fmt: skip
PARAMS = {
    "integration_time_s": 0.004, "optics_transmission": 0.765, "quantum_efficiency": 0.7,
    "read_noise_e": 400, "full_well_e": 7e6, "bits": 14,
}  # fmt: skip


def camera(scene=None, **params):
    return sensor("focal_plane", {**PARAMS, **params}, scene={**SCENE, **(scene or {})}, init=INIT)


def widest(widget, colour):
    """Pixels of the longest line of a colour."""
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    flat = np.frombuffer(image.constBits(), np.uint32).reshape(image.height(), -1)
    alike = (flat[:, : image.width()] & 0xFFFFFF) == (QColor(colour).rgb() & 0xFFFFFF)
    return int(alike.sum(axis=1).max())


def test_electrons_and_noises_of_the_reference():
    budget = answer(ElectronsQuery("node"), camera())
    assert budget.fill == pytest.approx(EXPECTED["well_fill_percent"] / 100, rel=1e-6)
    assert budget.sources_e["scene"] == pytest.approx(EXPECTED["signal_e"], rel=1e-6)
    assert budget.noises_e["shot"] == pytest.approx(EXPECTED["shot_noise_e"], rel=1e-6)
    assert budget.noises_e["read"] == 400
    assert budget.temporal_e / budget.per_K == pytest.approx(EXPECTED["netd_K"], rel=1e-6)
    assert budget.netd_K == pytest.approx(EXPECTED["netd_K"], rel=1e-6)


def test_in_words(bench):
    words = told(bench.show(camera()))
    assert words.startswith("453 ke⁻: 6.47 % of the well; shot noise 673 e⁻, 39 mK; ")
    assert "all that is temporal noise 793 e⁻, 45.9 mK" in words
    assert words.endswith("; NETD 45.9 mK")


def test_the_well_and_the_bars_are_to_scale(bench):
    """Ten times the exposure fills 65 %, so that a pixel more or less does not matter."""
    widget = bench.show(camera(integration_time_s=0.04, dark_current_e_per_s=4e7), width=460)
    scene, _, _, dark = DARK.curves[:4]
    well = 460 - 8
    filled = 10 * EXPECTED["signal_e"] / 7e6
    assert widest(widget, scene) == pytest.approx(filled * well, abs=2)
    assert widest(widget, dark) == pytest.approx(0.04 * 4e7 / 7e6 * well, abs=2)
    shot, read, _, _ = DARK.curves[4:8]
    ratio = np.sqrt(10 * EXPECTED["signal_e"] + 0.04 * 4e7) / 400
    assert widest(widget, shot) / widest(widget, read) == pytest.approx(ratio, rel=0.05)


def test_a_well_that_overflows_is_framed_in_the_colour_of_errors(bench):
    assert widest(bench.show(camera()), DARK.error) == 0
    full = bench.show(camera(integration_time_s=0.1))
    assert widest(full, DARK.error) > 100
    assert "162 % of the well" in told(full)


def test_without_a_well_or_a_warm_scene_it_says_what_there_is(bench):
    words = told(bench.show(camera(full_well_e=None, gain_e_per_dn=2.0)))
    assert words.startswith("453 ke⁻, no full well given; ")
    visible = {"cut_on_um": 0.5, "cut_off_um": 0.7, "temperature_K": 3000.0}
    words = told(bench.show(camera(visible, photon_weighting="source", integration_time_s=1e-6)))
    assert " K" not in words
    assert "; SNR " in words
