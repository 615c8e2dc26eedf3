"""The unit that Read Image gives to its samples, and the factor it applies."""

import numpy as np
import pytest

from core.errors import FileError, ParameterError
from node_bench import NodeBench
from nodes.files.formats import write_picture
from picture_samples import envi

CUBE = np.random.default_rng(3).uniform(1, 2, (2, 3, 4))


def reading(folder, **params):
    return NodeBench(folder, {"in": ("read_image", params)}, precision="double")


def cube_in(folder, unit):
    """Two bands of 1 µm, 8 to 10 µm; no unit where it is empty."""
    fields = {"wavelength": "{8.5, 9.5}", "fwhm": "{1, 1}"} | ({"data_units": unit} if unit else {})
    envi(folder / "x.img", CUBE.transpose(1, 2, 0), "bsq", **fields)


@pytest.mark.parametrize(
    ("unit", "factor", "name"),
    [
        ("W/m^2/sr/um", 1.0, "W/m²/sr/µm"),
        ("W cm-2 sr-1 um-1", 1e4, "W/m²/sr/µm"),
        ("uW/cm^2/sr/um", 1e-2, "W/m²/sr/µm"),
        ("µW/(cm² sr nm)", 10.0, "W/m²/sr/µm"),
        ("mW/(m^2 sr cm^-1)", 1e-3, "W/m²/sr/cm⁻¹"),
        ("mW/cm2/sr", 10.0, "W/m²/sr"),
        ("K", 1.0, "K"),
        ("DN", 1.0, "DN"),
    ],
)
def test_one_band_by_the_files_unit(tmp_path, unit, factor, name):
    cube_in(tmp_path, unit)
    bench = reading(tmp_path, path="x.img", band=1)
    assert bench.port("in.image").unit == name
    np.testing.assert_allclose(bench.value("in.image"), CUBE[1] * factor, rtol=1e-15)


@pytest.mark.parametrize(
    ("unit", "typed", "factor"),
    [
        ("uW/cm^2/sr/um", "W/m²/sr", 1e-2),
        ("uW/cm^2/sr/nm", "W/m²/sr", 10.0),
        ("W/m^2/sr/um", "", 1.0),
        ("", "W/m²/sr/µm", 1.0),
        ("", "uW/cm^2/sr/nm", 10.0),
        ("", "uW/cm^2/sr", 1e-2),
    ],
)
def test_bands_integrated_by_the_files_unit_or_the_typed_one(tmp_path, unit, typed, factor):
    cube_in(tmp_path, unit)
    bench = reading(tmp_path, path="x.img", cut_on_um=8.0, cut_off_um=9.5, unit=typed)
    assert bench.port("in.image").unit == "W/m²/sr"
    wanted = (CUBE[0] + 0.5 * CUBE[1]) * factor
    np.testing.assert_allclose(bench.value("in.image"), wanted, rtol=1e-14)


def test_a_scale_stands_for_the_conversion(tmp_path):
    cube_in(tmp_path, "furlongs of W/sr")
    bench = reading(tmp_path, path="x.img", scale=5.0)
    assert bench.port("in.image").unit == "W/m²/sr"
    np.testing.assert_allclose(bench.value("in.image"), 5 * CUBE[0], rtol=1e-15)


def test_photons_are_kept_when_asked_for_and_never_watts(tmp_path):
    cube_in(tmp_path, "photons/s/cm^2/sr/um")
    error = reading(tmp_path, path="x.img").error("in")
    assert isinstance(error, FileError)
    assert "photons/s/cm^2/sr/um" in error.message
    assert "unit = photons/s/m²/sr/µm" in error.message
    bench = reading(tmp_path, path="x.img", unit="photons/s/m²/sr/µm")
    assert bench.port("in.image").unit == "photons/s/m²/sr/µm"
    np.testing.assert_allclose(bench.value("in.image"), 1e4 * CUBE[0], rtol=1e-15)
    bench = reading(tmp_path, path="x.img", unit="photons/s/m²/sr", cut_on_um=8, cut_off_um=10)
    assert bench.port("in.image").unit == "photons/s/m²/sr"
    np.testing.assert_allclose(bench.value("in.image"), 1e4 * CUBE.sum(axis=0), rtol=1e-14)


@pytest.mark.parametrize(
    ("unit", "params", "kind", "words"),
    [
        ("W/m2/sr/furlong", {}, FileError, "'W/m2/sr/furlong' is not understood; allowed: W"),
        ("W/m2", {}, FileError, "'W/m2' is not understood"),
        ("", {"unit": "W/m2/sr/furlong"}, ParameterError, "unit = 'W/m2/sr/furlong'"),
        (
            "W/m2/sr/um",
            {"unit": "photons/s/m2/sr/um"},
            ParameterError,
            "same kind as the file's unit, W/m2/sr/um",
        ),
        ("W/m2/sr/um", {"unit": "K"}, ParameterError, "same kind as the file's unit, W/m2/sr/um"),
        (
            "",
            {"unit": "W/m2/sr/cm-1", "cut_on_um": 8, "cut_off_um": 10},
            ParameterError,
            "per µm or nm",
        ),
    ],
)
def test_what_cannot_be_taken_is_refused_at_planning(tmp_path, unit, params, kind, words):
    cube_in(tmp_path, unit)
    error = reading(tmp_path, path="x.img", **params).error("in")
    assert isinstance(error, kind)
    assert words in error.message
    assert error.node == "in"


def test_a_typed_unit_overrules_a_name_and_what_is_not_understood(tmp_path):
    for unit in ("counts", "W/m2/sr/furlong"):
        cube_in(tmp_path, unit)
        bench = reading(tmp_path, path="x.img", unit="mW/m2/sr/um")
        assert bench.port("in.image").unit == "W/m²/sr/µm"
        np.testing.assert_allclose(bench.value("in.image"), 1e-3 * CUBE[0], rtol=1e-15)


def test_header_says_integers_and_channels(tmp_path):
    np.save(tmp_path / "a.npy", CUBE[0])
    header = reading(tmp_path, path="a.npy").port("in.image").header
    assert (header.bare_integers, header.channels) == (False, ())
    colours = np.arange(36, dtype=np.uint8).reshape(3, 4, 3)
    for name in ("a.png", "a.tif"):
        write_picture(tmp_path / name, colours, dtype="uint8")
        bench = reading(tmp_path, path=name, band=1)
        header = bench.port("in.image").header
        assert (header.bare_integers, header.channels) == (True, ("R", "G", "B"))
        np.testing.assert_array_equal(bench.value("in.image"), colours[:, :, 1])
    write_picture(tmp_path / "b.png", colours[:, :, :2], dtype="uint8")  # grey and alpha
    assert reading(tmp_path, path="b.png").port("in.image").header.channels == ()
