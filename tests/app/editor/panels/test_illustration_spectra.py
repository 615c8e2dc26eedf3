"""The response over the scene's spectrum, and the air over the band, on their panels."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtGui import QColor, QImage

from app.editor.panels.illustrations.path_illustration import PathQuery
from app.editor.panels.illustrations.response_illustration import ResponseQuery
from app.editor.theme import DARK, LIGHT
from core.editing.operations import set_node_field
from core.network.file import load_network
from core.network.network import Link, Node
from cube_files import C1_UM, C2_UM
from cube_network import write_cube_network
from illustration_hands import LIBRARY, answer, sensor, told

QE = "wavelength_um,qe\n3.0,0.4\n4.0,0.8\n5.0,0.2\n"
SCENE = {"cut_on_um": 3.0, "cut_off_um": 5.0, "width": 16, "height": 16}


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


def colours_of(widget):
    image = widget.grab().toImage().convertToFormat(QImage.Format.Format_RGB32)
    flat = np.frombuffer(image.constBits(), np.uint32).reshape(image.height(), -1)
    return flat[:, : image.width()] & 0xFFFFFF


def count(widget, colour):
    return int((colours_of(widget) == (QColor(colour).rgb() & 0xFFFFFF)).sum())


def test_the_quantum_efficiency_within_the_filter_over_the_mean_spectrum(cube, tmp_path):
    network, samples, wavelengths = cube
    drawn = answer(ResponseQuery("fpa"), network, tmp_path)
    places, values = drawn.response.wavelength_um, drawn.response.values
    inside = (places >= 3.4) & (places <= 4.7)
    wanted = np.where(places <= 4.0, 0.4 + 0.4 * (places - 3.0), 0.8 - 0.6 * (places - 4.0))
    assert values == pytest.approx(np.where(inside, wanted, 0.0), abs=1e-12)
    assert drawn.response.band_um == pytest.approx((3.0, 5.0))
    for end in (3.4, 4.7):  # upright where the filter ends
        near = np.abs(places - end) < 1e-6
        assert values[near].min() == 0.0
        assert values[near].max() > 0.3
    assert drawn.spectrum.centres_um == pytest.approx(wavelengths)
    assert drawn.spectrum.means == pytest.approx(samples.mean(axis=(1, 2)), rel=1e-9)
    assert drawn.spectrum.unit == "W/m²/sr/µm"


def test_a_spectral_response_over_the_spectrum_and_without_one(cube, tmp_path):
    network, samples, _ = cube
    params = {"shape": "gaussian", "centre_um": 4.0, "width_um": 0.5}
    drawn = answer(
        ResponseQuery("node"), behind_the_file(network, "spectral_response", params), tmp_path
    )
    half = np.interp(4.25, drawn.response.wavelength_um, drawn.response.values)
    assert half == pytest.approx(0.5, rel=1e-3)
    assert drawn.spectrum.means == pytest.approx(samples.mean(axis=(1, 2)), rel=1e-9)
    alone = answer(ResponseQuery("node"), sensor("spectral_response", params, scene=SCENE))
    assert alone.spectrum is None
    assert alone.response.values.max() == pytest.approx(1.0, abs=1e-3)


def test_focal_plane_without_bands_has_no_chart_and_no_more_height(bench, cube):
    init = {"detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 100, "f_number": 4}
    plain = bench.show(sensor("focal_plane", {"full_well_e": 7e6}, scene=SCENE, init=init))
    height = plain.sizeHint().height()
    assert "quantum efficiency" not in told(plain)
    bench.close()
    with_bands = bench.show(cube[0], node="fpa")
    assert with_bands.sizeHint().height() > 1.5 * height


@pytest.mark.parametrize("theme", [DARK, LIGHT], ids=["dark", "light"])
def test_focal_plane_draws_both(bench, cube, theme):
    widget = bench.show(cube[0], node="fpa", theme=theme)
    widget.resize(360, widget.sizeHint().height())
    words = told(widget)
    assert "quantum efficiency up to 0.8 from 3.4 to 4.7 µm; mean spectrum of 12 bands" in words
    assert words.endswith("W/m²/sr/µm")
    rows = np.nonzero(colours_of(widget) == (QColor(theme.curves[1]).rgb() & 0xFFFFFF))[0]
    assert rows.max() > 0.6 * widget.height()  # the spectrum, below the noises


def test_a_disabled_focal_plane_says_so(bench, cube, session):
    widget = bench.show(cube[0], node="fpa")
    session.do(set_node_field("fpa", "disabled", True))
    bench.settle()
    assert told(widget).startswith("disabled")


def test_the_air_over_the_band():
    """3 km of 5 km visibility: Koschmieder's 3.912/V at 0.55 µm, as (0.55/λ)^1.3."""
    params = {"model": "visibility_km", "visibility_km": 5.0, "angstrom_q": 1.3,
              "range_m": 3000.0, "air_K": 288.0}  # fmt: skip
    path = answer(PathQuery("node"), sensor("atmospheric_path", params, scene=SCENE))
    places = path.wavelength_um
    passed = np.exp(-3.912 / 5.0 * 3.0 * (0.55 / places) ** 1.3)
    planck = C1_UM / places**5 / np.expm1(C2_UM / places / 288.0)
    assert (places[0], places[-1]) == (3.0, 5.0)
    assert path.transmission == pytest.approx(passed, rel=1e-12)
    assert path.added == pytest.approx((1 - passed) * planck, rel=1e-8)


def test_the_air_in_words_and_colours(bench):
    grey = bench.show(sensor("atmospheric_path", {"transmission": 0.7}, scene=SCENE))
    assert told(grey) == "mean transmission of the band 0.7"
    assert count(grey, DARK.curves[1]) == 0  # nothing is added
    bench.close()
    warm = sensor("atmospheric_path", {"transmission": 0.7, "air_K": 300.0}, scene=SCENE)
    widget = bench.show(warm)
    assert "; the air adds " in told(widget)
    assert count(widget, DARK.curves[1]) > 20


def test_the_points_of_a_table_are_drawn(tmp_path):
    (tmp_path / "tau.csv").write_text("um,tau\n3.0,0.9\n4.2,0.9\n4.26,0.0\n4.3,0.9\n5.0,0.9\n")
    network = sensor("atmospheric_path", {"path": "tau.csv"}, scene=SCENE)
    path = answer(PathQuery("node"), network, tmp_path)
    assert path.transmission.min() == 0.0
    assert path.wavelength_um[path.transmission.argmin()] == 4.26
