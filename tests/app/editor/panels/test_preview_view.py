"""Previews on the screen: they follow the document, and go with their panel."""

import math
import weakref

import numpy as np
import pytest
import shiboken6
from PySide6.QtWidgets import QWidget
from scipy import constants, integrate

from app.editor.panels.preview_view import NOTHING, PreviewView, preview_query
from app.editor.panels.transfer_preview import TransferPreviewQuery, transfer_lines
from app.run.shipped import shipped_networks
from battery_settings import EXAMPLES
from core.editing.operations import remove_nodes, set_parameter
from core.modules.preview import Bars, Stack, brief
from core.network.file import load_network
from core.network.network import Network, Node
from cube_files import C1_UM, C2_UM
from cube_network import write_cube_network
from lens_files import write_lens_files
from panel_hands import let_go
from preview_hands import INFRAMETRICS, LIBRARY, Paints, passing, previewed, sensor, told

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
        "MTF at the Nyquist frequency 0.489 cyc/mrad: 0.183; MTF50 0.312 cyc/mrad"
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


SCENE = {"cut_on_um": 3.0, "cut_off_um": 5.0, "width": 16, "height": 16}


def curve(preview, name="", part=0):
    """The points of a named curve of a chart."""
    (found,) = (c for c in preview.parts[part].curves if c.name == name)
    return np.asarray(found.x), np.asarray(found.y)


def test_the_detectors_of_the_inframetrics_are_drawn_to_scale():
    preview = previewed(sensor("jitter_mtf", init={**INFRAMETRICS, "platform": "line"}), "init")
    assert "Nyquist 0.489 cyc/mrad, IFOV 4.38 mrad" in preview.words
    (sensitive,) = (c for c in preview.parts[0].curves if c.fill == "inside")
    (pitch,) = (c for c in preview.parts[0].curves if c.style == "dotted")
    assert [np.ptp(sensitive.x), np.ptp(sensitive.y)] == pytest.approx([4.3846] * 2, abs=5e-5)
    assert [np.ptp(pitch.x), np.ptp(pitch.y)] == pytest.approx([600 / 130] * 2)
    (dots,) = (c for c in preview.parts[0].curves if c.style == "dots")
    assert np.diff(np.unique(dots.x)) == pytest.approx(0.5 / 0.488924, rel=1e-5)


def pupil(**params):
    return previewed(Network(nodes={"node": Node("node", "exit_pupil", params)}))


def test_the_rms_and_the_open_share_of_a_pupil():
    coefficients = [0.0, 0.05, 0.0, 0.1, -0.02, 0.0, 0.03, 0.0, 0.0, 0.0, 0.04]
    expected = math.sqrt(sum(c**2 for c in coefficients))
    text = pupil(zernike_waves=coefficients).facts[-1]
    assert float(text.split()[1]) == pytest.approx(expected, rel=0.02)
    for params, share in (
        ({}, 100),
        ({"shape": "cassegrain"}, 100 * (1 - 1 / 9)),
        ({"shape": "hinged", "slit_width": 30}, 100 * (1 - 0.2531)),  # a bar of 0.4 radii
    ):
        text = pupil(**params).facts[3]
        assert float(text.split()[0]) == pytest.approx(share, abs=1)


def background_limit(wavelength_um, *, efficiency, cut_off_um, factor, kelvin, half_angle_deg):
    """(λ/hc)·√(η/(m·Q)), cm √Hz/W, Q the photons of a black body in a cone, m⁻² s⁻¹."""
    h, c, k = constants.h, constants.c, constants.k

    def photons(wavelength_m):
        return 2 * c / wavelength_m**4 / math.expm1(h * c / (wavelength_m * k * kelvin))

    radiance, _ = integrate.quad(photons, 0.5e-6, cut_off_um * 1e-6, epsrel=1e-10, limit=200)
    flux = math.pi * math.sin(math.radians(half_angle_deg)) ** 2 * radiance
    return 100 * wavelength_um * 1e-6 / (h * c) * math.sqrt(efficiency / (factor * flux))


def loose(**params):
    """Electronics & Noise without inputs: the makers' conditions, 300 K in a cone of 60°."""
    return previewed(Network(nodes={"node": Node("node", "electronics_noise", params)}))


def peak(preview):
    """Wavelength and D* of the curve's mark."""
    return preview.parts[0].marks[0].x, preview.parts[0].marks[0].y


def test_the_curve_of_a_background_limited_detector():
    material, efficiency, cut_off = "Si:Ga", 0.3, 17.1
    found = loose(region="LWIR", material=material)
    wavelength_um, values = curve(found, material)
    inside = wavelength_um <= cut_off
    cone = {"kelvin": 300.0, "half_angle_deg": 30.0}
    expected = background_limit(
        wavelength_um[inside], efficiency=efficiency, cut_off_um=cut_off, factor=4, **cone
    )
    np.testing.assert_allclose(values[inside], expected, rtol=1e-6)
    assert values[-1] < 1  # nothing beyond the cut-off
    assert wavelength_um[-1] == pytest.approx(cut_off)
    assert peak(found)[0] == pytest.approx(cut_off)
    assert found.parts[0].x.title == "wavelength (µm), 300 K in a cone of 60°"
    assert found.parts[1] == "not connected yet: image, context"


def test_the_curve_of_a_sensor_sees_the_scene_through_its_optics():
    params = {"region": "LWIR", "material": "HgCdTe", "scan_mirror_rate_Hz": 16.0}
    scene = {"kind": "uniform", "temperature_K": 290.0}
    network = sensor("electronics_noise", params, scene=scene, init=INFRAMETRICS)
    found = previewed(network)
    seen = {
        **{"efficiency": 0.7, "cut_off_um": 12.5, "factor": 4, "kelvin": 290.0},
        "half_angle_deg": math.degrees(math.atan(1 / 3.5)),
    }
    expected = background_limit(12.0, **seen)
    assert peak(found)[0] == pytest.approx(12.0)  # the band ends before the material
    assert peak(found)[1] == pytest.approx(expected, rel=1e-4)
    ends, (of_band, _) = curve(found, "band")
    assert tuple(ends) == found.parts[0].band == (8.0, 12.0)
    least = background_limit(8.0, **seen)
    assert least < of_band < expected
    detector, amplifier, system = (bar.size for bar in found.parts[1].bars)
    assert system == pytest.approx(math.hypot(detector, amplifier))


def test_the_published_netd_of_a_typed_detectivity():
    network = load_network(shipped_networks()["kodak_kir310_1996"], library=LIBRARY)
    network = network.with_parameter("electronics", "background_K", 305.0)
    found = previewed(network, "electronics")
    assert curve(found, "entered")[1][0] == 3e13
    assert found.parts[1].bars[0].size == pytest.approx(0.0065, abs=5e-5)  # table 5.4, at 305 K


EXPECTED = {  # camera_values.json, camera-shared-0
    "signal_e": 453078.91635770707839, "well_fill_percent": 6.472555947967243977,
    "shot_noise_e": 673.11136995129348237, "netd_K": 0.045923803888498956611,
}  # fmt: skip
CAMERA_SCENE = {
    "kind": "uniform", "width": 16, "height": 12, "temperature_K": 293.15,
    "cut_on_um": 3.7, "cut_off_um": 4.8, "fov_x_deg": 1.0, "fov_y_deg": 1.0,
}  # fmt: skip
CAMERA_INIT = {
    "detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 100, "f_number": 4,
    "fill_x": 0.95, "fill_y": 0.95, "platform": "array",
}  # fmt: skip
CAMERA_PARAMS = {
    "integration_time_s": 0.004, "optics_transmission": 0.765, "quantum_efficiency": 0.7,
    "read_noise_e": 400, "full_well_e": 7e6, "bits": 14,
}  # fmt: skip


def camera(scene=None, **params):
    return previewed(
        sensor(
            "focal_plane",
            {**CAMERA_PARAMS, **params},
            scene={**CAMERA_SCENE, **(scene or {})},
            init=CAMERA_INIT,
        )
    )


def test_electrons_and_noises_of_the_reference():
    preview = camera()
    well, noises = preview.parts
    assert isinstance(well, Stack)
    assert isinstance(noises, Bars)
    shares = {part.name: part.size / well.whole for part in well.parts}
    assert sum(shares.values()) == pytest.approx(EXPECTED["well_fill_percent"] / 100, rel=1e-6)
    assert well.parts[0].size == pytest.approx(EXPECTED["signal_e"], rel=1e-6)
    sizes = {bar.name: bar.size for bar in noises.bars}
    assert sizes["shot"] == pytest.approx(EXPECTED["shot_noise_e"], rel=1e-6)
    assert sizes["read"] == 400
    assert preview.words == (
        "453 ke⁻: 6.47 % of the well; shot noise 673 e⁻, 39 mK; read noise 400 e⁻, 23.2 mK; "
        "rounding noise 123 e⁻, 7.15 mK; fixed pattern noise 0 e⁻, 0 K; "
        "total temporal noise 793 e⁻, 45.9 mK; NETD 45.9 mK"
    )


QE = "wavelength_um,qe\n3.0,0.4\n4.0,0.8\n5.0,0.2\n"


@pytest.fixture
def cube(tmp_path):
    (tmp_path / "qe.csv").write_text(QE)
    given = {"response": "qe.csv", "cut_on_um": 3.4, "cut_off_um": 4.7}
    samples, wavelengths, _ = write_cube_network(tmp_path, LIBRARY, focal_plane=given)
    return load_network(tmp_path / "cube.json", library=LIBRARY), samples, wavelengths


def test_the_quantum_efficiency_within_the_filter_over_the_mean_spectrum(cube, tmp_path):
    network, samples, wavelengths = cube
    preview = previewed(network, "fpa", tmp_path)
    places, values = curve(preview, "response", part=2)
    inside = (places >= 3.4) & (places <= 4.7)
    wanted = np.where(places <= 4.0, 0.4 + 0.4 * (places - 3.0), 0.8 - 0.6 * (places - 4.0))
    assert values == pytest.approx(np.where(inside, wanted, 0.0), abs=1e-12)
    assert (places[0], places[-1]) == pytest.approx((3.0, 5.0))
    for end in (3.4, 4.7):  # upright where the filter ends
        near = np.abs(places - end) < 1e-6
        assert values[near].min() == 0.0
        assert values[near].max() > 0.3
    centres, heights = curve(preview, "scene", part=2)
    means = samples.mean(axis=(1, 2))
    assert centres == pytest.approx(wavelengths)
    assert heights / heights.max() == pytest.approx(means / means.max(), rel=1e-9)
    words = "quantum efficiency up to 0.8 from 3.4 to 4.7 µm; mean spectrum of 12 bands"
    assert words in preview.words
    assert preview.words.endswith("2.64 W/m²/sr/µm")


def test_the_air_over_the_band():
    """3 km of 5 km visibility: Koschmieder's 3.912/V at 0.55 µm, as (0.55/λ)^1.3."""
    params = {"model": "visibility_km", "visibility_km": 5.0, "angstrom_q": 1.3,
              "range_m": 3000.0, "air_K": 288.0}  # fmt: skip
    preview = previewed(sensor("atmospheric_path", params, scene=SCENE))
    places, transmission = curve(preview)
    passed = np.exp(-3.912 / 5.0 * 3.0 * (0.55 / places) ** 1.3)
    planck = C1_UM / places**5 / np.expm1(C2_UM / places / 288.0)
    assert (places[0], places[-1]) == (3.0, 5.0)
    assert transmission == pytest.approx(passed, rel=1e-12)
    assert curve(preview, part=1)[1] == pytest.approx((1 - passed) * planck, rel=1e-8)


def test_an_aperture_is_shown_up_to_its_cutoff():
    x, y = transfer_lines(passing(sensor("exit_pupil_mtf", pupil={"radius": 75.0})), "node", "mtf")
    for line in (x, y):
        assert line.cutoff == pytest.approx(7.5, rel=1e-9)  # 7.5 cm over 10 µm
        assert line.frequency[-1] == pytest.approx(7.5, rel=1e-9)
        assert line.at_nyquist == pytest.approx(0.9171, abs=5e-5)
        ratio = line.frequency / 7.5
        disc = 2 / np.pi * (np.arccos(ratio) - ratio * np.sqrt(1 - ratio**2))
        np.testing.assert_allclose(line.values, disc, atol=1e-9)


TRANSFER = {
    "jitter_mtf": {"sigma_mrad": 0.6},
    "vibration_mtf": {"amplitude_x_mrad": 2.0, "amplitude_y_mrad": 1.0},  # J₀: below 0
    "gaussian_mtf": {"sigma_x_mrad": 0.01, "sigma_y_mrad": 0.02},  # hardly any blur
    "charge_eff_phase": {"model": "published", "efficiency": 0.999},
}


@pytest.mark.parametrize("key", TRANSFER)
def test_a_transfer_function_fills_its_chart_and_marks_lie_on_it(key):
    part = "ptf" if key.endswith("phase") else "mtf"
    seen = passing(sensor(key, TRANSFER[key]))
    (chart,) = TransferPreviewQuery("node", part).answer(seen).parts
    lines = transfer_lines(seen, "node", part)
    values = np.concatenate([line.values for line in lines])
    span = chart.y.reach - chart.y.low
    assert chart.y.low <= values.min()
    assert chart.y.reach >= values.max()
    assert chart.y.high == pytest.approx(chart.y.reach + 0.22 * span)  # room for words
    assert np.ptp(values) >= 0.07 * span if key == "gaussian_mtf" else np.ptp(values) >= 0.4 * span
    assert chart.x.low == 0.0
    assert chart.x.high == pytest.approx(1.03 * max(line.nyquist for line in lines))
    for curve in chart.curves:
        if curve.name:
            line = lines["xy".index(curve.name[0])]
            np.testing.assert_array_equal(curve.y, line.values)
    for mark in chart.marks:
        assert np.abs(
            np.interp(mark.x, lines[mark.colour].frequency, lines[mark.colour].values)
        ) == (pytest.approx(0.5, abs=1e-3))
    assert {at for at, *_ in chart.uprights} == {line.nyquist for line in lines}
