import numpy as np
import pytest

from core.errors import FileError, ParameterError
from nodes.files import envi
from nodes.files.envi import band_weights_um, integrate_bands
from picture_samples import envi as write_envi


def write(folder, cube, wavelengths, fwhm=None, units="Micrometers", **fields):
    """Write (rows, columns, bands) with the bands' wavelengths."""
    for key, values in (("wavelength", wavelengths), ("fwhm", fwhm)):
        if values is not None:
            fields[key] = "{" + ", ".join(map(repr, map(float, values))) + "}"
    return write_envi(folder / "x.img", cube, wavelength_units=units, **fields)


def random_cube(bands, rows=4, columns=3):
    return np.random.default_rng(7).random((rows, columns, bands))


def test_bands_within_the_interval_are_weighted_by_their_width(tmp_path):
    cube = random_cube(3)
    data = write(tmp_path, cube, [8.1, 8.4, 9.0], [0.2, 0.4, 0.8])
    truth = 0.2 * cube[:, :, 0] + 0.4 * cube[:, :, 1] + 0.8 * cube[:, :, 2]
    read = integrate_bands(data, 8.0, 9.4)
    assert read.dtype == np.float64
    np.testing.assert_allclose(read, truth, rtol=1e-13)


def test_bands_cut_by_the_interval_count_by_their_overlap(tmp_path):
    cube = random_cube(3)
    data = write(tmp_path, cube, [8.5, 9.5, 10.5], [1, 1, 1])
    read = integrate_bands(data, 8.75, 10.25)
    truth = 0.25 * cube[:, :, 0] + cube[:, :, 1] + 0.25 * cube[:, :, 2]
    np.testing.assert_allclose(read, truth, rtol=1e-13)
    inside_one = integrate_bands(data, 9.2, 9.3)
    np.testing.assert_allclose(inside_one, 0.1 * cube[:, :, 1], rtol=1e-12)


def test_constant_spectrum_gives_radiance_times_width_whatever_the_widths(tmp_path):
    data = write(tmp_path, np.full((2, 2, 5), 3.0), [8, 8.5, 9, 9.5, 10], [0.5, 0.9, 1.4, 0.7, 0.6])
    np.testing.assert_allclose(integrate_bands(data, 8.1, 9.9), 3.0 * 1.8, rtol=1e-13)


def test_without_widths_the_whole_spectrum_is_the_trapezoid_rule(tmp_path):
    wavelengths = np.array([8, 8.3, 9.1, 9.2, 10.4])
    cube = random_cube(5)
    data = write(tmp_path, cube, wavelengths)
    truth = np.trapezoid(cube, wavelengths, axis=2)
    np.testing.assert_allclose(integrate_bands(data, 8, 10.4), truth, rtol=1e-13)


def test_bands_in_any_order(tmp_path):
    order = [2, 0, 1]
    cube = random_cube(3)
    wavelengths = np.array([8.0, 9.0, 10.0])
    data = write(tmp_path, cube[:, :, order], wavelengths[order])
    truth = np.trapezoid(cube, wavelengths, axis=2)
    np.testing.assert_allclose(integrate_bands(data, 8, 10), truth, rtol=1e-13)


def test_wavelengths_in_nanometers_and_radiance_per_nanometer(tmp_path):
    cube = random_cube(2)
    data = write(tmp_path, cube, [8500, 9500], [1000, 1000], "Nanometers")
    np.testing.assert_allclose(integrate_bands(data, 8, 10), cube.sum(axis=2), rtol=1e-13)
    unit = "W/(m^2 sr nm)"
    data = write(tmp_path, cube, [8500, 9500], [1000, 1000], "nm", data_units=unit)
    np.testing.assert_allclose(integrate_bands(data, 8, 10), 1000 * cube.sum(axis=2), rtol=1e-13)


def test_single_precision_is_summed_in_double(tmp_path):
    cube = np.full((2, 3, 1000), 0.1, dtype=np.float32)
    wavelengths = 8 + 0.001 * np.arange(1000)
    data = write(tmp_path, cube, wavelengths, np.full(1000, 0.001))
    read = integrate_bands(data, 8, 8.9985)
    assert read.dtype == np.float32
    np.testing.assert_allclose(read, np.float64(np.float32(0.1)) * 0.9985, rtol=1e-7)


def test_more_rows_than_a_block(tmp_path):
    cube = np.random.default_rng(1).random((3000, 20, 60))
    data = write(tmp_path, cube, np.arange(60) + 1.0, np.ones(60))
    np.testing.assert_allclose(integrate_bands(data, 10.5, 12.5), cube[:, :, 10:12].sum(2), 1e-14)


def test_interval_beyond_the_bands_is_refused_unless_asked_for(tmp_path):
    cube = random_cube(2)
    data = write(tmp_path, cube, [8.5, 9.5], [1, 1])
    with pytest.raises(
        ParameterError, match=r"between 8 and 10 um and cover 2 um of this interval"
    ):
        integrate_bands(data, 7.5, 13)
    with pytest.raises(ParameterError, match=r"cover 0 um of this interval"):
        integrate_bands(data, 3, 5, min_coverage=0)
    read = integrate_bands(data, 7.5, 13, min_coverage=0)
    np.testing.assert_allclose(read, cube.sum(axis=2), rtol=1e-13)


@pytest.mark.parametrize("interval", [(9, 9), (10, 9), (-1, 9), (float("nan"), 9), (9, np.inf)])
def test_bad_interval(tmp_path, interval):
    data = write(tmp_path, random_cube(2), [8.5, 9.5], [1, 1])
    with pytest.raises(ParameterError, match="cut_o"):
        integrate_bands(data, *interval)


def test_no_wavelengths(tmp_path):
    data = write(tmp_path, random_cube(2), None)
    with pytest.raises(FileError, match="gives no wavelengths"):
        integrate_bands(data, 8, 9)
    data = write(tmp_path, random_cube(1), [8.5])
    with pytest.raises(FileError, match="gives no fwhm"):
        integrate_bands(data, 8, 9)


def test_samples_already_integrated_are_refused(tmp_path):
    data = write(tmp_path, random_cube(2), [8.5, 9.5], [1, 1], data_units="W/m^2/sr")
    with pytest.raises(FileError, match=r"W/m\^2/sr, which is not per wavelength"):
        integrate_bands(data, 8, 10)


def test_weights_sum_to_the_covered_width(tmp_path):
    info = envi.read_info(write(tmp_path, random_cube(3), [8.5, 9.5, 12], [1, 1.5, 0.5]))
    weights = band_weights_um(info, cut_on_um=7, cut_off_um=12)
    assert weights.sum() == pytest.approx(2.25 + 0.25, rel=1e-14)


def test_a_sample_missing_in_a_used_band_is_missing_in_the_sum(tmp_path):
    cube = random_cube(3)
    cube[1, 2, 0] = cube[2, 1, 2] = -1.0
    data = write(tmp_path, cube, [8.5, 9.5, 10.5], [1, 1, 1], data_ignore_value=-1)
    read = integrate_bands(data, 8, 10)
    truth = cube[:, :, :2].sum(axis=2)
    truth[1, 2] = np.nan
    np.testing.assert_allclose(read, truth, rtol=1e-13)


def test_a_unit_that_is_not_understood_is_refused(tmp_path):
    data = write(tmp_path, random_cube(2), [8.5, 9.5], [1, 1], data_units="W/m^2/sr/furlong")
    with pytest.raises(FileError, match=r"'W/m\^2/sr/furlong' is not understood"):
        integrate_bands(data, 8, 10)
