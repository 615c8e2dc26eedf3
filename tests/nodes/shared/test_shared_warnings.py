"""When a band, a unit or a wavelength disagrees so far that a node warns of it."""

import pytest

from nodes.shared.shared_warnings import band_caution, is_radiance, unit_caution, wavelength_caution


@pytest.mark.parametrize(
    ("own", "silent"),
    [
        ((8.0, 12.0), True),
        ((8.1, 12.0), True),  # 97.5 % of both
        ((8.0, 10.0), False),
        ((3.0, 5.0), False),
        ((12.0, 14.0), False),
        ((7.0, 14.0), False),
        ((None, None), True),
        ((None, 12.0), True),
        ((9.0, None), False),
    ],
)
def test_bands_that_are_alike_enough(own, silent):
    assert (band_caution((8.0, 12.0), *own) is None) == silent
    assert band_caution(None, *own) is None


def test_a_share_of_the_bands_is_told():
    assert "share 50 % of their width" in band_caution((8.0, 12.0), 8.0, 10.0).message


@pytest.mark.parametrize(
    "unit", ["W/m²/sr", "W m-2 sr-1", "W·m⁻²·sr⁻¹", "W/sr/m²", "W/(m^2*sr)", " W/m2/sr "]
)
def test_what_is_radiance_however_it_is_worded(unit):
    assert is_radiance(unit)
    assert unit_caution(unit, meant="NETD") is None


@pytest.mark.parametrize(
    "unit",
    ["K", "DN", "counts", "", "reflectance", "W/m²/sr/µm", "W", "mW/m2/sr", "W/m2/sr/furlong"],
)
def test_what_is_no_radiance(unit):
    assert not is_radiance(unit)
    assert unit_caution(unit, meant="NETD") is not None


@pytest.mark.parametrize(("wavelength", "silent"), [(8.0, True), (12.0, True), (7.0, False)])
def test_the_ends_of_a_band_belong_to_it(wavelength, silent):
    found = wavelength_caution((8.0, 12.0), wavelength, name="wavelength_um")
    assert (found is None) == silent
