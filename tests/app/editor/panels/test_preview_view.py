"""Previews on the screen: they follow the document, and go with their panel."""

import weakref

import numpy as np
import pytest
import shiboken6
from PySide6.QtWidgets import QWidget

from app.editor.panels.preview_view import NOTHING, PreviewView, preview_query
from app.run.shipped import shipped_networks
from battery_settings import EXAMPLES
from core.editing.operations import remove_nodes, set_parameter
from core.modules.preview import brief
from core.network.file import load_network
from core.network.network import Network, Node
from lens_files import write_lens_files
from panel_hands import let_go
from preview_hands import LIBRARY, Paints, sensor, told

ILLUSTRATED = [key for key in LIBRARY if preview_query(LIBRARY[key], "node") is not None]
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
    "psf_file": ({"path": "psf.txt", "sample_pitch": 0.1, "pitch_unit": "mrad"}, "background", 0.9),
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


# Curves, a drawing, a picture, bars, and what files are read for.
SHOWN = ("jitter_mtf", "exit_pupil", "test_scene", "electronics_noise", "psf_file")
some = pytest.mark.thorough(but=4, always=SHOWN)


def test_each_mtf_module_and_every_special_panel_has_one():
    special = {"init_trans", "exit_pupil", "electronics_noise", "charge_eff_phase"}
    measured = {key for key, module in LIBRARY.items() if module.group == "Analysis"}
    wanted = {key for key in LIBRARY if key.endswith("_mtf")} - measured | special
    assert wanted <= set(ILLUSTRATED)
    assert set(EDITS) <= set(ILLUSTRATED)
    assert "back_transform" not in ILLUSTRATED


@some
@pytest.mark.parametrize("key", ILLUSTRATED)
def test_it_follows_edits_and_undo(qtbot, session, bench, tmp_path, key):
    np.save(tmp_path / "one.npy", np.linspace(1, 2, 64 * 64).reshape(64, 64))
    write_lens_files(tmp_path)
    params, name, value = edit_of(key)
    widget = bench.show(network_of(key, params))
    before = told(widget)
    assert before
    assert widget.preview is not None
    paints = Paints(widget)
    session.do(set_parameter("node", name, value))
    bench.settle()
    after = widget.accessibleDescription()
    assert after != before
    assert paints.count > 0
    assert widget.preview is not None
    session.undo()
    bench.settle()
    assert told(widget) == before


@some
@pytest.mark.parametrize("key", ILLUSTRATED)
def test_a_node_that_is_not_connected_has_a_preview_or_says_that_it_has_none(bench, key):
    widget = bench.show(Network(nodes={"node": Node("node", key)}))
    assert told(widget)
    assert (told(widget) == NOTHING) == (widget.preview is None)
    assert (widget.preview is None) or key not in ("jitter_mtf", "gaussian_mtf")


def test_it_goes_with_its_panel(qtbot, session, bench):
    key = "jitter_mtf"
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


def test_the_essential_numbers_are_told_in_words_and_nothing_of_what_waits(session, bench):
    widget = bench.show(sensor("jitter_mtf", {"sigma_mrad": 0.6}))
    assert told(widget) == (
        "MTF at the Nyquist frequency 0.489 cyc/mrad: 0.183; half contrast at 0.312 cyc/mrad"
    )
    session.do(remove_nodes(("scene",)))
    bench.settle()
    assert told(widget) == NOTHING


def test_numbers_are_brief():
    for value, text in (
        (0.48892, "0.489"),
        (-0.0201, "\N{MINUS SIGN}0.0201"),
        (1.1e11, "1.1·10¹¹"),
        (9.996e-5, "1·10⁻⁴"),
        (float("inf"), "inf"),
    ):
        assert brief(value) == text


def test_where_it_is_low_it_leaves_parts_out_rather_than_drawing_them_small(bench):
    widget = bench.show(
        load_network(shipped_networks()["mwir_camera"], library=LIBRARY), "focal_plane"
    )
    line, whole = widget.fontMetrics().height(), widget.sizeHint().height()
    assert widget.height_within(10 * whole) == whole
    low = widget.height_within(8 * line)
    assert 2 * line < low < 8 * line  # the well above, without the bars of noise
    assert widget.height_within(low) == low
