import numpy as np
import pytest

from core.errors import FileError, ParameterError
from nodes.files.envi import integrate_bands
from picture_samples import envi as write_envi


def write(folder, cube, wavelengths, fwhm=None, units="Micrometers", **fields):
    """Write (rows, columns, bands) with the bands' wavelengths."""
    for key, values in (("wavelength", wavelengths), ("fwhm", fwhm)):
        if values is not None:
            fields[key] = "{" + ", ".join(map(repr, map(float, values))) + "}"
    return write_envi(folder / "x.img", cube, wavelength_units=units, **fields)


def random_cube(bands, rows=4, columns=3):
    return np.random.default_rng(7).random((rows, columns, bands))


def test_without_widths_the_whole_spectrum_is_the_trapezoid_rule(tmp_path):
    wavelengths = np.array([8, 8.3, 9.1, 9.2, 10.4])
    cube = random_cube(5)
    data = write(tmp_path, cube, wavelengths)
    truth = np.trapezoid(cube, wavelengths, axis=2)
    np.testing.assert_allclose(integrate_bands(data, 8, 10.4), truth, rtol=1e-13)


def test_wavelengths_in_nanometers_and_radiance_per_nanometer(tmp_path):
    cube = random_cube(2)
    data = write(tmp_path, cube, [8500, 9500], [1000, 1000], "Nanometers")
    np.testing.assert_allclose(integrate_bands(data, 8, 10), cube.sum(axis=2), rtol=1e-13)
    unit = "W/(m^2 sr nm)"
    data = write(tmp_path, cube, [8500, 9500], [1000, 1000], "nm", data_units=unit)
    np.testing.assert_allclose(integrate_bands(data, 8, 10), 1000 * cube.sum(axis=2), rtol=1e-13)


def test_interval_beyond_the_bands_is_refused_unless_asked_for(tmp_path):
    cube = random_cube(2)
    data = write(tmp_path, cube, [8.5, 9.5], [1, 1])
    with pytest.raises(ParameterError, match=r"cover 2 µm .* lie between 8 and 10 µm"):
        integrate_bands(data, 7.5, 13)
    with pytest.raises(ParameterError, match=r"cover 0 µm of this interval"):
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


def test_a_sample_missing_in_a_used_band_is_missing_in_the_sum(tmp_path):
    cube = random_cube(3)
    cube[1, 2, 0] = cube[2, 1, 2] = -1.0
    data = write(tmp_path, cube, [8.5, 9.5, 10.5], [1, 1, 1], data_ignore_value=-1)
    read = integrate_bands(data, 8, 10)
    truth = cube[:, :, :2].sum(axis=2)
    truth[1, 2] = np.nan
    np.testing.assert_allclose(read, truth, rtol=1e-13)
