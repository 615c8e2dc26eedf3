"""The previews that modules make, against formulas, printed figures and a reference's camera."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import constants, integrate

from app.run.shipped import shipped_networks
from core.errors import ParameterError
from core.modules.preview import Bars, Stack
from core.network.file import load_network
from core.network.network import Link, Network, Node
from core.physics.optics.pupil_shapes import PupilShape
from cube_files import C1_UM, C2_UM
from cube_network import write_cube_network
from nodes.optics.exit_pupil import open_share
from preview_hands import INFRAMETRICS, LIBRARY, previewed, sensor

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


def test_there_is_no_detector_without_a_focal_length():
    init = {"detector_x_um": 30.0, "detector_y_um": 30.0}
    preview = previewed(sensor("jitter_mtf", init=init), "init")
    assert [c.style for c in preview.parts[0].curves] == ["dots"]
    assert preview.words.endswith("detector pitch or focal length is missing")


def pupil(**params):
    return previewed(Network(nodes={"node": Node("node", "exit_pupil", params)}))


def test_the_rms_of_a_wavefront_is_that_of_its_coefficients():
    coefficients = [0.0, 0.05, 0.0, 0.1, -0.02, 0.0, 0.03, 0.0, 0.0, 0.0, 0.04]
    expected = math.sqrt(sum(c**2 for c in coefficients))
    text = pupil(zernike_waves=coefficients).facts[-1]
    assert float(text.split()[1]) == pytest.approx(expected, rel=0.02)


def test_defocus_is_nothing_in_the_middle_and_all_at_the_rim():
    preview = pupil(defocus_waves=0.5)
    picture = preview.parts[0].picture
    middle = len(picture.samples) // 2
    assert picture.samples[middle, middle] == pytest.approx(0.0, abs=2e-3)
    assert np.nanmin(picture.samples) == pytest.approx(0.0, abs=2e-3)
    assert (np.nanmax(picture.samples), picture.high) == pytest.approx((0.5, 0.5), rel=0.03)
    assert preview.facts[-1] == "rms 0.144 waves"  # 0.5 / sqrt(12)
    assert np.nanmax(pupil().parts[0].picture.samples) == 0.0


def test_the_wavefront_of_an_annulus_is_told_where_it_is_open():
    preview = pupil(defocus_waves=1.0, shape="cassegrain", radius=100.0, obscuration_radius=50.0)
    samples = preview.parts[0].picture.samples
    assert np.nanmin(samples) == pytest.approx(0.25, abs=0.03)
    assert float(preview.facts[-1].split()[1]) == pytest.approx(0.75 / math.sqrt(12), rel=0.03)


def test_the_half_moon_is_open_at_its_right():
    known = np.isfinite(pupil(shape="half_moon", radius=200.0).parts[0].picture.samples)
    assert not known[:, : known.shape[1] // 2].any()
    assert known[:, known.shape[1] // 2 :].mean() > 0.4


def test_the_middle_of_the_array_is_drawn_where_the_aperture_is_small():
    drawn = pupil(radius=20.0, size_x=1024).parts[0]
    assert (2 * drawn.x.high, 2 * drawn.y.low) == (128.0, 64.0)
    assert 2 * pupil(radius=200.0, size_x=1024).parts[0].x.high == 1024.0


def test_a_pupil_larger_than_its_array_is_refused():
    with pytest.raises(ParameterError, match="at least the aperture's diameter 800"):
        pupil(radius=400.0)


def slit_share(outer, inner, width):
    """Share of a disc left by an annulus with a bar, by integration across the bar."""
    x = np.linspace(-width / 2, width / 2, 20001)
    chord = 2 * (np.sqrt(outer**2 - x**2) - np.sqrt(np.maximum(inner**2 - x**2, 0)))
    covered = np.trapezoid(chord, x)
    return (math.pi * (outer**2 - inner**2) - covered) / (math.pi * outer**2)


def spider_of_two(outer, width):
    """Two opposite vanes are a bar; a hole no wider than the bar takes nothing more."""
    return slit_share(outer, 0, width)


@pytest.mark.parametrize(
    ("shape", "share"),
    [
        (PupilShape("clear", 75.0), 1.0),
        (PupilShape("half_moon", 75.0), 0.5),
        (PupilShape("cassegrain", 75.0, 25.0), 8 / 9),
        (PupilShape("hinged", 75.0, slit_width=30.0), slit_share(75, 0, 30)),
        (PupilShape("cassegrain_slit", 75.0, 25.0, 30.0), slit_share(75, 25, 30)),
        (PupilShape("spider", 75.0, 5.0, vanes=2, vane_width=10.0), spider_of_two(75, 10)),
    ],
    ids=lambda value: getattr(value, "shape", ""),
)
def test_how_much_of_the_disc_is_open(shape, share):
    assert open_share(shape) == pytest.approx(share, abs=1e-4)


def test_a_pupil_of_a_file_is_made_small(tmp_path):
    samples = np.zeros((600, 1200))
    samples[:, 600:] = 2.0
    np.save(tmp_path / "pupil.npy", samples)
    params = {"shape": "file", "path": "pupil.npy"}
    network = Network(nodes={"node": Node("node", "exit_pupil", params)})
    found = previewed(network, folder=tmp_path)
    assert found.words == "file, 1200 × 600 samples, 50 % transmitted"
    small = found.parts[0].picture.samples
    high, wide = small.shape
    assert wide == 2 * high <= 320
    assert (small[:, : wide // 2] == 0).all()
    assert (small[:, wide // 2 :] == 1).all()


def test_a_picture_has_its_extremes_and_its_shape():
    scene = {"kind": "two_panel", "width": 900, "height": 300}
    (found,) = previewed(sensor("jitter_mtf", scene=scene), "scene").parts
    high, wide = found.samples.shape
    assert wide == 3 * high <= 320
    assert (found.samples.min(), found.samples.max()) == pytest.approx((found.low, found.high))
    assert found.low < found.high


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


@pytest.mark.parametrize(
    ("material", "efficiency", "cut_off"), [("HgCdTe", 0.7, 12.5), ("Si:Ga", 0.3, 17.1)]
)
def test_the_curve_of_a_background_limited_detector(material, efficiency, cut_off):
    found = loose(region="LWIR", material=material)
    wavelength_um, values = curve(found, material)
    inside = wavelength_um <= cut_off
    expected = background_limit(
        wavelength_um[inside],
        efficiency=efficiency,
        cut_off_um=cut_off,
        factor=4,
        kelvin=300.0,
        half_angle_deg=30.0,
    )
    np.testing.assert_allclose(values[inside], expected, rtol=1e-6)
    assert values[-1] < 1  # nothing beyond the cut-off
    assert wavelength_um[-1] == pytest.approx(cut_off)
    assert peak(found)[0] == pytest.approx(cut_off)
    assert found.parts[0].x.title == "wavelength (µm), 300 K in a cone of 60°"
    assert found.parts[1] == "not connected yet: image, context"


@pytest.mark.parametrize(
    ("region", "material", "band", "peak_um", "stated"),
    [  # EG&G Judson 1995 for the infrared, a maker's 1 GΩ of 1 mm² for silicon
        ("LWIR", "HgCdTe", {}, 12.5, 4e10),
        ("MWIR", "InSb", {"cut_on_um": 3.0, "cut_off_um": 5.0}, 5.0, 1e11),
        ("VIS", "Si", {}, 1.107, 1e13),
    ],
)
def test_peaks_are_about_what_makers_state(region, material, band, peak_um, stated):
    found = loose(region=region, material=material, **band)
    assert peak(found)[0] == pytest.approx(peak_um)
    assert stated / 2 < peak(found)[1] < stated * 2


def test_the_curve_of_a_sensor_sees_the_scene_through_its_optics():
    params = {"region": "LWIR", "material": "HgCdTe", "scan_mirror_rate_Hz": 16.0}
    scene = {"kind": "uniform", "temperature_K": 290.0}
    network = sensor("electronics_noise", params, scene=scene, init=INFRAMETRICS)
    found = previewed(network)
    half_angle = math.degrees(math.atan(1 / 3.5))
    expected = background_limit(
        12.0, efficiency=0.7, cut_off_um=12.5, factor=4, kelvin=290.0, half_angle_deg=half_angle
    )
    assert peak(found)[0] == pytest.approx(12.0)  # the band ends before the material
    assert peak(found)[1] == pytest.approx(expected, rel=1e-4)
    ends, (of_band, _) = curve(found, "band")
    assert tuple(ends) == found.parts[0].band == (8.0, 12.0)
    least = background_limit(
        8.0, efficiency=0.7, cut_off_um=12.5, factor=4, kelvin=290.0, half_angle_deg=half_angle
    )
    assert least < of_band < expected
    detector, amplifier, system = (bar.size for bar in found.parts[1].bars)
    assert system == pytest.approx(math.hypot(detector, amplifier))


def test_the_published_netd_of_a_typed_detectivity():
    network = load_network(shipped_networks()["kodak_kir310_1996"], library=LIBRARY)
    network = network.with_parameter("electronics", "background_K", 305.0)
    found = previewed(network, "electronics")
    assert curve(found, "entered")[1][0] == 3e13
    assert found.parts[1].bars[0].size == pytest.approx(0.0065, abs=5e-5)  # table 5.4, at 305 K


def test_a_manual_detector_has_no_curve():
    found = loose(region="LWIR", material="manual", d_star=2e10)
    assert [c.name for c in found.parts[0].curves] == ["entered"]
    assert curve(found, "entered")[1][0] == 2e10


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


def test_excess_noise_has_a_bar_of_its_own():
    plain, gained = camera(), camera(charge_gain="photoconductive")
    bars = gained.parts[1].bars
    assert [bar.name for bar in bars[:3]] == ["shot", "excess", "read"]
    assert bars[1].size == pytest.approx(EXPECTED["shot_noise_e"], rel=1e-6)
    assert bars[2].colour == plain.parts[1].bars[1].colour
    assert gained.more_lines > plain.more_lines == 0


def test_a_well_that_overflows():
    assert not camera().parts[0].excess
    full = camera(integration_time_s=0.1)
    assert full.parts[0].excess
    assert "162 % of the well" in full.words


def test_without_a_well_or_a_warm_scene_it_says_what_there_is():
    words = camera(full_well_e=None, gain_e_per_dn=2.0).words
    assert words.startswith("453 ke⁻, no full well entered; ")
    visible = {"cut_on_um": 0.5, "cut_off_um": 0.7, "temperature_K": 3000.0}
    words = camera(visible, photon_weighting="source", integration_time_s=1e-6).words
    assert " K" not in words
    assert "; SNR " in words


QE = "wavelength_um,qe\n3.0,0.4\n4.0,0.8\n5.0,0.2\n"


@pytest.fixture
def cube(tmp_path):
    (tmp_path / "qe.csv").write_text(QE)
    given = {"response": "qe.csv", "cut_on_um": 3.4, "cut_off_um": 4.7}
    samples, wavelengths, _ = write_cube_network(tmp_path, LIBRARY, focal_plane=given)
    return load_network(tmp_path / "cube.json", library=LIBRARY), samples, wavelengths


def behind_the_file(network, key, params):
    """A node on the cube."""
    nodes = {**network.nodes, "node": Node("node", key, params)}
    return replace(
        network, nodes=nodes, links=(*network.links, Link.between("read.image", "node.image"))
    )


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


def test_a_spectral_response_over_the_spectrum_and_without_one(cube, tmp_path):
    network, samples, _ = cube
    params = {"shape": "gaussian", "centre_um": 4.0, "width_um": 0.5}
    preview = previewed(behind_the_file(network, "spectral_response", params), folder=tmp_path)
    assert np.interp(4.25, *curve(preview, "response")) == pytest.approx(0.5, rel=1e-3)
    means, heights = samples.mean(axis=(1, 2)), curve(preview, "scene")[1]
    assert heights / heights.max() == pytest.approx(means / means.max(), rel=1e-9)
    alone = previewed(sensor("spectral_response", params, scene=SCENE))
    assert [c.name for c in alone.parts[0].curves] == ["response"]
    assert curve(alone, "response")[1].max() == pytest.approx(1.0, abs=1e-3)


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


def test_air_that_adds_nothing_has_one_chart():
    grey = previewed(sensor("atmospheric_path", {"transmission": 0.7}, scene=SCENE))
    assert grey.words == "mean transmission of the band 0.7"
    assert len(grey.parts) == 1
    warm = {"transmission": 0.7, "air_K": 300.0}
    warm = previewed(sensor("atmospheric_path", warm, scene=SCENE))
    assert "; the air adds " in warm.words
    assert len(warm.parts) == 2


def test_the_points_of_a_table_are_drawn(tmp_path):
    (tmp_path / "tau.csv").write_text("um,tau\n3.0,0.9\n4.2,0.9\n4.26,0.0\n4.3,0.9\n5.0,0.9\n")
    network = sensor("atmospheric_path", {"path": "tau.csv"}, scene=SCENE)
    places, transmission = curve(previewed(network, folder=tmp_path))
    assert transmission.min() == 0.0
    assert places[transmission.argmin()] == 4.26
