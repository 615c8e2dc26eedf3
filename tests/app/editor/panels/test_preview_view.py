"""Previews on the screen: they follow the document, and go with their panel."""

import weakref

import numpy as np
import pytest
import shiboken6
from PySide6.QtGui import QFont
from PySide6.QtWidgets import QWidget

from app.editor.evaluation.queries import Answer
from app.editor.panels.preview_view import PreviewView, preview_query
from app.editor.panels.transfer_preview import shrunk
from app.editor.theme import DARK, LIGHT
from battery_settings import EXAMPLES
from core.editing.document import Document
from core.editing.operations import Remove, set_node_field, set_parameter
from core.errors import DataError, ParameterError
from core.modules.preview import brief, kelvin, pair
from core.network.network import Network, Node
from lens_files import write_lens_files
from panel_hands import let_go
from preview_hands import (
    LIBRARY,
    Paints,
    grey_pixels,
    sensor,
    told,
)

ILLUSTRATED = [key for key in LIBRARY if preview_query(LIBRARY[key], "node") is not None]
# Those with a preview of their own, and one of those whose curve is drawn.
OF_EACH_KIND = tuple(
    key for key in ILLUSTRATED if LIBRARY[key].preview is not None or key == "jitter_mtf"
)
INIT = {"detector_x_um": 60.0, "detector_y_um": 60.0, "focal_length_mm": 50.0, "f_number": 2.0}
MOVING = {"range_m": 1000.0, "integration_time_s": 0.01}

# Parameters to begin with, and an edit whose effect is told.
EDITS = {
    "charge_diffusion_mtf": ({"absorption_per_um": 0.05}, "diffusion_length_um", 300.0),
    "read_image": ({"path": "one.npy"}, "scale", 3.0),
    "test_scene": ({"width": 64, "height": 64}, "delta_K", 25.0),
    "init_trans": ({**INIT}, "focal_length_mm", 75.0),
    "atmosphere_mtf": ({"fwhm_mrad": 0.5}, "fwhm_mrad", 1.0),
    "exit_pupil": ({}, "radius", 90.0),
    "exit_pupil_mtf": ({}, "size_x_cm", 12.8),
    "gaussian_mtf": ({"sigma_x_mrad": 0.2}, "sigma_x_mrad", 0.5),
    "crosstrack_mtf": ({"dwell_time_s": 0.001}, "scan_velocity_mrad_per_s", 900.0),
    "alongtrack_mtf": ({**MOVING, "velocity_m_per_s": 50.0}, "velocity_m_per_s", 90.0),
    "relative_motion_mtf": ({**MOVING, "image_velocity_x": 50.0}, "image_velocity_x", 90.0),
    "jitter_mtf": ({"sigma_mrad": 0.3}, "sigma_mrad", 0.6),
    "vibration_mtf": ({"amplitude_x_mrad": 0.2}, "amplitude_x_mrad", 0.4),
    "detector_mtf": ({}, "fill_x", 0.5),
    "charge_eff_mtf": ({}, "efficiency", 0.999),
    "charge_eff_phase": ({"model": "published"}, "efficiency", 0.999),
    "electronics_noise": (
        {"region": "LWIR", "scan_mirror_rate_Hz": 16.0, "amplifier_snr": 100.0},
        "material",
        "Si:Ga",
    ),
    "periodic_noise": ({"amplitude": 1.0}, "amplitude", 2.0),
    "camera_geometry": ({"fov_x_deg": 3.0}, "fov_x_deg", 2.0),
    "psf_file": (
        {"path": "psf.txt", "sample_pitch": 0.1, "pitch_unit": "mrad"},
        "background",
        0.9,
    ),
    "spectral_response": ({}, "peak", 0.5),
    "atmospheric_path": ({"transmission": 0.8}, "air_K", 280.0),
    "tdi_mtf": ({}, "velocity_mismatch_percent", 5.0),
    "microbolometer": ({}, "time_constant_s", 0.03),
}


def edit_of(key):
    """Its row, else the first setting of its example on top of the defaults."""
    return EDITS.get(key) or ({}, *next(iter(EXAMPLES[key].items())))


def network_of(key, params):
    scene = {"width": 64, "height": 64, "fov_x_deg": 4.0, "fov_y_deg": 4.0}
    init = {**INIT, "scan_velocity_mrad_per_s": 300.0}
    return sensor(key, params, scene=scene, init=init)


def test_each_mtf_module_and_every_special_panel_has_one():
    special = {"init_trans", "exit_pupil", "electronics_noise", "charge_eff_phase"}
    measured = {key for key, module in LIBRARY.items() if module.group == "Analysis"}
    wanted = {key for key in LIBRARY if key.endswith("_mtf")} - measured | special
    assert wanted <= set(ILLUSTRATED)
    assert set(EDITS) <= set(ILLUSTRATED)
    assert "back_transform" not in ILLUSTRATED


@pytest.mark.parametrize("key", ILLUSTRATED)
def test_it_follows_edits_and_undo(qtbot, session, bench, tmp_path, key):
    np.save(tmp_path / "one.npy", np.linspace(1, 2, 64 * 64).reshape(64, 64))
    write_lens_files(tmp_path)
    params, name, value = edit_of(key)
    widget = bench.show(network_of(key, params))
    before = told(widget)
    assert before
    assert not widget.problem
    paints = Paints(widget)
    session.do(set_parameter("node", name, value))
    bench.settle()
    after = widget.accessibleDescription()
    assert after != before
    assert paints.count > 0
    assert not widget.problem
    session.undo()
    bench.settle()
    assert told(widget) == before


@pytest.mark.parametrize("key", ILLUSTRATED)
def test_a_node_that_is_not_connected_says_what_is_missing(bench, key):
    widget = bench.show(Network(nodes={"node": Node("node", key)}))
    missing = widget.missing_inputs()
    assert told(widget)
    if missing and key != "periodic_noise":  # which is drawn from its parameters alone
        assert f"not connected yet: {', '.join(missing)}" in told(widget)
    if key == "jitter_mtf":
        assert missing == ("context", "magnitude")


@pytest.mark.thorough(but=9, always=OF_EACH_KIND)
@pytest.mark.parametrize("key", ILLUSTRATED)
@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
def test_it_can_be_narrow_and_wide_and_large_in_both_looks(bench, tmp_path, key, theme):
    np.save(tmp_path / "one.npy", np.eye(64))
    widget = bench.show(network_of(key, edit_of(key)[0]), theme=theme)
    height = widget.sizeHint().height()
    for width in (280, 460):
        widget.resize(width, height)
        assert grey_pixels(widget).std() > 1
    large = QFont(widget.font())
    large.setPointSizeF(2 * large.pointSizeF())
    widget.setFont(large)
    assert widget.sizeHint().height() == pytest.approx(2 * height, rel=0.1)
    widget.resize(widget.sizeHint())
    shown = grey_pixels(widget)
    widget.setPalette((LIGHT if theme is DARK else DARK).palette())
    assert (grey_pixels(widget).mean() > shown.mean()) == (theme is DARK)


@pytest.mark.thorough(always=OF_EACH_KIND)
@pytest.mark.parametrize("key", ILLUSTRATED)
def test_it_goes_with_its_panel(qtbot, session, bench, tmp_path, key):
    np.save(tmp_path / "one.npy", np.eye(64))
    bench.show(network_of(key, edit_of(key)[0]))
    panel = QWidget()
    qtbot.addWidget(panel)
    widget = PreviewView(session, bench.evaluator, "node", panel)
    panel.show()
    bench.settle()
    kept = weakref.ref(widget)
    widget.deleteLater()
    del widget
    let_go()
    assert kept() is None or not shiboken6.isValid(kept())
    session.do(set_parameter("node", *edit_of(key)[1:]))  # nobody listens any more
    bench.settle()
    let_go()
    assert kept() is None


def test_without_a_worker_it_says_so(bench):
    widget = bench.show(network_of("jitter_mtf", {}), evaluated=False)
    assert told(widget) == "nothing is computed here"
    assert widget.accessibleName() == "illustration of node: Jitter MTF"


def test_the_essential_numbers_are_told_in_words(bench):
    widget = bench.show(sensor("jitter_mtf", {"sigma_mrad": 0.6}))
    assert told(widget) == (
        "MTF at the Nyquist frequency 0.489 cyc/mrad: 0.183; half contrast at 0.312 cyc/mrad"
    )


def test_answers_to_others_are_not_its_own(qtbot, session, bench):
    widget = bench.show(network_of("jitter_mtf", {}))
    before = told(widget)
    query = widget.queries()[0]
    error = DataError("not for it")
    bench.evaluator.answered.emit(Answer(99, "somebody else", query, error=error))
    assert told(widget) == before
    assert not widget.problem


def test_a_disabled_node_says_so(qtbot, session, bench):
    widget = bench.show(network_of("jitter_mtf", {}))
    session.do(set_node_field("node", "disabled", True))
    bench.settle()
    assert told(widget).startswith("disabled")
    grey_pixels(widget)


def test_an_error_further_up_is_named_by_its_node(qtbot, session, bench):
    widget = bench.show(network_of("jitter_mtf", {}))
    session.do(Remove(("scene",)))
    bench.settle()
    assert told(widget) == "waits for init: input image is not connected"


def test_a_parameter_further_up_is_named_behind_its_node(qtbot, session, bench):
    widget = bench.show(network_of("jitter_mtf", {}))
    error = ParameterError("aperture_mm", None, "above 0", unit="mm", node="lens")
    assert widget.in_short(error) == "waits for lens: Aperture is empty: above 0 (mm)"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (0.48892, "0.489"),
        (1.0, "1"),
        (1234.5, "1234"),
        (-0.0201, "\N{MINUS SIGN}0.0201"),
        (1.1e11, "1.1·10¹¹"),
        (4e10, "4·10¹⁰"),
        (9.996e-5, "1·10⁻⁴"),
        (float("inf"), "inf"),
    ],
)
def test_numbers_are_brief(value, text):
    assert brief(value) == text


def test_small_temperatures_are_in_millikelvin():
    assert kelvin(0.0065) == "6.5 mK"
    assert kelvin(0.177) == "0.177 K"
    assert kelvin(0.0) == "0 K"
    assert pair(1.0, 2.0) == "1 × 2"
    assert pair(1.0, 1.0001) == "1"


@pytest.mark.thorough(always=OF_EACH_KIND)
@pytest.mark.parametrize("key", ILLUSTRATED)
def test_another_module_under_its_name_does_not_trouble_it(bench, session, key):
    """A document may be opened while the panel of a node of the same name is still there."""
    widget = bench.show(sensor(key, EXAMPLES.get(key, {})))
    other = "jitter_mtf" if key != "jitter_mtf" else "examine_image"
    session.open(Document(sensor(other), library=session.library))
    bench.settle()
    widget.repaint()
    session.open(Document(Network(), library=session.library))
    bench.settle()
    widget.repaint()


@pytest.mark.parametrize("shape", [(1, 1), (7, 5), (640, 640), (641, 3), (1, 5000), (2047, 999)])
def test_a_small_picture_keeps_its_mean(shape):
    rng = np.random.default_rng(5)
    slope = np.add.outer(np.linspace(0, 1, shape[0]), np.linspace(0, 2, shape[1]))
    small = shrunk(slope + 1e-6 * rng.standard_normal(shape), 64)
    assert max(small.shape) <= 64
    assert small.flags.c_contiguous
    assert small.mean() == pytest.approx(slope.mean(), abs=0.05)
    longest = max(range(2), key=lambda axis: shape[axis])
    assert small.shape[longest] >= min(shape[longest], 32)
