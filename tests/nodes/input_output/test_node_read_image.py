"""Read Image against files made without it."""

import os

import numpy as np
import pytest
import zarr

from core.errors import DataError, FileError, ParameterError
from node_bench import NodeBench
from nodes.files.picture_info import PictureInfo
from nodes.input_output.read_image import header_band
from picture_samples import envi as write_envi


def reading(folder, precision="double", **params):
    return NodeBench(folder, {"in": ("read_image", params)}, precision=precision)


def picture(rows=6, columns=9, seed=1):
    return np.random.default_rng(seed).uniform(-5, 60, (rows, columns))


def envi(folder, cube, **fields):
    """A bsq cube (bands, rows, columns) of doubles."""
    write_envi(folder / "x.img", cube.transpose(1, 2, 0), "bsq", **fields)


def test_reads_npy_scaled_with_interval(tmp_path):
    array = picture()
    np.save(tmp_path / "a.npy", array)
    bench = reading(tmp_path, path="a.npy", scale=2.5, unit="K", fov_x_deg=3.0, fov_y_deg=2.0)
    image = bench.port("in.image")
    assert (image.rows, image.columns, image.unit, image.band_um) == (6, 9, "K", None)
    assert image.interval_x_mrad == pytest.approx(np.radians(3.0) * 1000 / 9, rel=1e-14)
    assert image.interval_y_mrad == pytest.approx(np.radians(2.0) * 1000 / 6, rel=1e-14)
    assert image.header.fov_x_deg == 3.0
    np.testing.assert_array_equal(bench.value("in.image"), array * 2.5)
    single = reading(tmp_path, "single", path="a.npy").value("in.image")
    assert single.dtype == np.float32
    np.testing.assert_array_equal(single, array.astype(np.float32))


def test_key_follows_path_size_time_and_parameters(tmp_path):
    np.save(tmp_path / "a.npy", picture())

    def key(**params):
        return reading(tmp_path, path="a.npy", **params).port("in.image").key

    first = key()
    assert key() == first
    assert key(scale=1) == first
    assert key(scale=2.0) != first
    assert reading(tmp_path, path=str(tmp_path / "a.npy")).port("in.image").key == first
    os.utime(tmp_path / "a.npy", ns=(0, 12345))
    assert key() != first


def test_file_changed_between_plan_and_run_is_refused(tmp_path):
    np.save(tmp_path / "a.npy", picture())
    bench = reading(tmp_path, path="a.npy")
    np.save(tmp_path / "a.npy", picture(rows=7))
    with pytest.raises(FileError, match="changed since"):
        bench.value("in.image")


def test_envi_band_and_integration(tmp_path):
    cube = np.random.default_rng(2).uniform(1, 2, (3, 4, 5))
    extra = {
        "wavelength": "{8.0, 9.0, 10.0}",
        "fwhm": "{1.0, 1.0, 1.0}",
        "wavelength_units": "Micrometers",
        "data_units": "W/m^2/sr/um",
        "fov_x_deg": 4.0,
        "focal_length_mm": 130,
    }
    envi(tmp_path, cube, **extra)
    one = reading(tmp_path, path="x.img", band=1)
    image = one.port("in.image")
    assert image.band_um == pytest.approx((8.5, 9.5))
    assert image.header.focal_length_mm == 130
    assert image.interval_x_mrad == pytest.approx(np.radians(4.0) * 1000 / 5)
    assert image.interval_y_mrad is None
    np.testing.assert_array_equal(one.value("in.image"), cube[1])
    band = reading(tmp_path, path="x.img", cut_on_um=8.25, cut_off_um=10.5, scale=1e4)
    assert band.port("in.image").band_um == (8.25, 10.5)
    expected = 1e4 * (0.25 * cube[0] + cube[1] + cube[2])
    np.testing.assert_allclose(band.value("in.image"), expected, rtol=1e-14)
    # The header counts as much as the samples.
    before = one.port("in.image").key
    os.utime(tmp_path / "x.img.hdr", ns=(0, 5))
    assert reading(tmp_path, path="x.img", band=1).port("in.image").key != before


@pytest.mark.parametrize("bands", ["one", "all"])
def test_wavelengths_without_unit_are_warned_of(tmp_path, bands):
    fields = {"wavelength": "{8, 9, 10}", "fwhm": "{1, 1, 1}", "data_units": "W/m^2/sr/um"}
    said = []
    for extra in ({}, {"wavelength_units": "um"}):
        envi(tmp_path, np.ones((3, 4, 5)), **fields, **extra)
        bench = reading(tmp_path, path="x.img", bands=bands)
        said.append([str(caution) for caution in bench.warnings()])
    assert any("read as µm: the header gives no unit" in line for line in said[0])
    assert not any("µm" in line for line in said[1])


def said_by(bench):
    return [str(caution) for caution in bench.warnings()]


BANDS = {"wavelength_units": "um", "data_units": "W/m^2/sr/um", "wavelength": "{8, 9, 10, 11}"}


@pytest.mark.parametrize("fwhm", [None, "{1, 1, 1, 1}"])
@pytest.mark.parametrize("params", [{"bands": "all"}, {}])
def test_bands_that_the_header_marks_as_bad_are_left_out(tmp_path, fwhm, params):
    """Without fwhm their neighbours reach half-way to one another: the trapezoid rule."""
    cube = np.random.default_rng(3).uniform(1, 2, (4, 3, 5))
    cube[2] = np.nan
    widths = {} if fwhm is None else {"fwhm": fwhm}
    envi(tmp_path, cube, **BANDS, **widths, bbl="{1, 1, 0, 1}")
    bench = reading(tmp_path, path="x.img", cut_on_um=7.5, cut_off_um=11.5, **params)
    weights = [1.0, 1.5, 1.5] if fwhm is None else [1.0, 1.0, 1.0]
    truth = np.tensordot(weights, cube[[0, 1, 3]], 1)
    np.testing.assert_allclose(bench.value("in.image"), truth, rtol=1e-14)
    said = said_by(bench)
    assert any("1 band is left out, because the header marks it as bad" in it for it in said)
    assert any("the bands cover 75 % of the wavelengths from 7.5 to 11.5" in it for it in said) == (
        fwhm is not None
    )


@pytest.mark.parametrize("fwhm", [{}, {"fwhm": "{1, 1, 1, 1}"}])
def test_a_cube_of_which_all_bands_are_bad_is_refused(tmp_path, fwhm):
    envi(tmp_path, np.ones((4, 3, 5)), **BANDS, **fwhm, bbl="{0, 0, 0, 0}")
    with pytest.raises(FileError, match="marks all bands as bad"):
        reading(tmp_path, path="x.img", bands="all").value("in.image")


@pytest.mark.parametrize(
    ("interval", "share"), [({}, "80 % of the wavelengths from the first to the last band"),
                            ({"cut_on_um": 7.0, "cut_off_um": 9.5}, "60 % of the wavelengths from"),
                            ({"cut_on_um": 7.75, "cut_off_um": 8.25}, None)]
)  # fmt: skip
def test_bands_that_cover_a_part_of_the_range_are_warned_of(tmp_path, interval, share):
    """3 of the 3.75 µm from 7.75 to 11.5; from 7 to 9.5 µm 1.5 of 2.5."""
    widths = {"fwhm": "{0.5, 1, 0.5, 1}"}
    envi(tmp_path, np.ones((4, 3, 5)), **BANDS, **widths)
    said = said_by(reading(tmp_path, path="x.img", bands="all", **interval))
    found = [line for line in said if "the bands cover" in line]
    assert len(found) == (share is not None)
    assert share is None or share in found[0]


def test_chunks_that_a_store_lacks_are_warned_of(tmp_path):
    stored = zarr.create_array(tmp_path / "a.zarr", shape=(40, 40), chunks=(5, 20), dtype="f4")
    stored[10:] = 3.0
    bench = reading(tmp_path, path="a.zarr", missing="zero")
    said = said_by(bench)
    assert any("the store lacks 4 chunks" in line for line in said)
    assert bench.value("in.image").sum() == 3.0 * 30 * 40
    with pytest.raises(DataError, match="400 samples are not finite"):
        reading(tmp_path, path="a.zarr").value("in.image")


@pytest.mark.parametrize(
    ("params", "kind", "words"),
    [
        ({}, ParameterError, "path"),
        ({"path": "missing.npy"}, FileError, "no such file"),
        ({"path": "a.npy", "band": 1}, FileError, "no band 1"),
        ({"path": "a.npy", "cut_on_um": 3.0}, ParameterError, "cut_off_um"),
        ({"path": "a.npy", "cut_off_um": 3.0}, ParameterError, "cut_on_um"),
        ({"path": "a.npy", "cut_on_um": 5.0, "cut_off_um": 3.0}, ParameterError, "cut_off_um"),
        ({"path": "a.npy", "fov_x_deg": 180.0}, ParameterError, "fov_x_deg"),
    ],
)
def test_faults_of_reading_are_told_at_planning(tmp_path, params, kind, words):
    np.save(tmp_path / "a.npy", picture())
    error = reading(tmp_path, **params).error("in")
    assert isinstance(error, kind)
    assert error.node == "in"
    assert words in str(error)


def test_samples_not_finite_are_refused_with_their_place(tmp_path):
    array = picture()
    array[2, 3] = np.nan
    np.save(tmp_path / "a.npy", array)
    with pytest.raises(DataError, match="row 2, column 3"):
        reading(tmp_path, path="a.npy").value("in.image")
    np.save(tmp_path / "b.npy", np.full((2, 2), 1e30))
    with pytest.raises(DataError, match="scale = 1e\\+20"):
        reading(tmp_path, "single", path="b.npy", scale=1e20).value("in.image")


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_missing_samples_are_counted_and_stood_in_for_if_asked(tmp_path, bad, precision):
    array = np.array([[1.0, bad, 3.0], [bad, 8.0, 0.0]])
    np.save(tmp_path / "a.npy", array)
    for missing, value in (("mean", 3.0), ("zero", 0.0)):
        bench = reading(tmp_path, precision, path="a.npy", scale=2.0, missing=missing)
        expected = [[2.0, 2 * value, 6.0], [2 * value, 16.0, 0.0]]
        np.testing.assert_array_equal(bench.value("in.image"), expected)
        assert bench.readouts("in")["missing_samples"] == 2
    whole = np.where(np.isfinite(array), array, 7.0)
    np.save(tmp_path / "b.npy", whole)
    bench = reading(tmp_path, precision, path="b.npy", missing="mean")
    np.testing.assert_array_equal(bench.value("in.image"), whole)
    assert bench.readouts("in")["missing_samples"] == 0


def test_a_picture_of_nothing_has_no_mean(tmp_path):
    np.save(tmp_path / "a.npy", np.full((3, 4), np.nan))
    with pytest.raises(DataError, match="none of the 12 samples is finite"):
        reading(tmp_path, path="a.npy", missing="mean").value("in.image")


@pytest.mark.parametrize(
    ("wavelengths", "fwhm", "band", "expected"),
    [
        ((4.0, 10.0), (1.0, 2.0), 0, (3.5, 4.5)),
        ((4.0, 10.0), (1.0, 2.0), 1, (9.0, 11.0)),
        ((4.0, 10.0), (1.0, 2.0), (0, 1), None),  # a sum of bands
        (None, (1.0, 2.0), 0, None),
        ((4.0, 10.0), None, 0, None),
        ((4.0,), (8.0,), 0, None),  # would begin at 0
        ((4.0,), (7.9,), 0, (0.05, 7.95)),
    ],
)
def test_the_band_that_a_header_gives(tmp_path, wavelengths, fwhm, band, expected):
    info = PictureInfo(
        tmp_path, 1, 1, 2, "float32", "envi", wavelengths_um=wavelengths, fwhm_um=fwhm
    )
    assert header_band(info, band) == (None if expected is None else pytest.approx(expected))
