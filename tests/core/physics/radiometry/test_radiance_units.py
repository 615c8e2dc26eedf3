"""Units of radiance as files word them, against factors by hand."""

import pytest

from core.errors import DataError
from core.physics.radiometry.radiance_units import radiance_unit

BAND, PER_UM = "W/m²/sr", "W/m²/sr/µm"


@pytest.mark.parametrize(
    ("text", "factor", "name"),
    [
        ("W/m²/sr", 1.0, BAND),
        ("W·m⁻²·sr⁻¹", 1.0, BAND),
        ("W m-2 sr-1", 1.0, BAND),
        ("W.m-2.sr-1", 1.0, BAND),
        ("W m^{-2} sr^{-1}", 1.0, BAND),
        ("W/m**2/sr", 1.0, BAND),
        ("W/(m2 sr)", 1.0, BAND),
        ("W/m2*sr", 1.0, BAND),
        ("W per m2 per sr", 1.0, BAND),
        ("Radiance (W/m2/sr)", 1.0, BAND),
        ("kW/m²/sr", 1e3, BAND),
        ("mW/m²/sr", 1e-3, BAND),
        ("MW/m²/sr", 1e6, BAND),
        ("nW/cm^2/sr", 1e-5, BAND),
        ("W/mm2/sr", 1e6, BAND),
        ("W/km2/sr", 1e-6, BAND),
        ("W/m²/sr/µm", 1.0, PER_UM),
        ("W/m²/sr/μm", 1.0, PER_UM),
        ("W m-2 sr-1 um-1", 1.0, PER_UM),
        ("W/(m^2 sr um)", 1.0, PER_UM),
        ("W cm^-2 sr^-1 um^-1", 1e4, PER_UM),
        ("Watts/cm2/sr/um", 1e4, PER_UM),
        ("W/CM2/SR/UM", 1e4, PER_UM),
        ("uW/cm^2/sr/um", 1e-2, PER_UM),
        ("µW cm⁻² sr⁻¹ µm⁻¹", 1e-2, PER_UM),
        ("microwatts/cm2/sr/um", 1e-2, PER_UM),
        ("uW/(cm^2*nm*sr)", 10.0, PER_UM),
        ("mW/m^2-sr-um", 1e-3, PER_UM),
        ("W/m^2/um/sr", 1.0, PER_UM),
        ("(W)/(m^2)(µm)(sr)", 1.0, PER_UM),
        ("W/m²/sr/nm", 1e3, PER_UM),
        ("W/m²/sr/m", 1e-6, PER_UM),
        ("W/m²/sr/Å", 1e4, PER_UM),
        ("W/m2/sr/cm", 1e-4, PER_UM),
        ("mW/(m^2 sr cm^-1)", 1e-3, "W/m²/sr/cm⁻¹"),
        ("mW m-2 sr-1 (cm-1)-1", 1e-3, "W/m²/sr/cm⁻¹"),
        ("W/m2/sr/(1/cm)", 1.0, "W/m²/sr/cm⁻¹"),
        ("photons/s/cm^2/sr/um", 1e4, "photons/s/m²/sr/µm"),
        ("ph s-1 m-2 sr-1", 1.0, "photons/s/m²/sr"),
        ("PHOTONS/S/CM2/SR", 1e4, "photons/s/m²/sr"),
    ],
)
def test_a_unit_is_worth_what_it_says(text, factor, name):
    unit = radiance_unit(text)
    assert (unit.factor, unit.name) == (factor, name)


@pytest.mark.parametrize(
    "text",
    [
        "W/m2",  # no steradian: an irradiance
        "W/cm2/um",
        "photons/m2/sr",  # no second
        "W/s/m2/sr",
        "W2/m2/sr",
        "W/m/sr",
        "W/m2/sr/km",
        "W/m2/sr/furlong",
        "W/m2/sr um cm",
        "W/m2/sr cm",  # per cm, or per cm⁻¹
        "W/Mm2/sr",
        "MW/CM2/SR/UM",  # milli or mega
        "erg/s/cm2/sr",
        "10 W/m2/sr",
        "W/(m2 sr",
        "W/m2/sr)",
        "W//m2/sr",
        "W/m2/sr/",
        "W m-2 2 sr-1",
        "sr",
        "W/m²/sr#",
    ],
)
def test_what_is_not_understood_is_refused_with_what_is(text):
    with pytest.raises(DataError) as caught:
        radiance_unit(text)
    assert repr(text) in str(caught.value)
    assert "photons/s" in str(caught.value)
    assert "uW/cm^2/sr/um" in str(caught.value)


@pytest.mark.parametrize(
    "text", ["", "K", "DN", "counts", "reflectance", "radiance", "°C", "W", "photons", "e-", "1/m"]
)
def test_what_is_no_radiance_is_none(text):
    assert radiance_unit(text) is None


SIZES = {"": ("", 1.0), "c": ("centi", 1e-2), "m": ("milli", 1e-3), "u": ("micro", 1e-6),
         "n": ("nano", 1e-9), "k": ("kilo", 1e3)}  # fmt: skip


@pytest.mark.parametrize("prefix", SIZES)
def test_prefixes_and_words_of_lengths_and_powers(prefix):
    """Per area, per wavelength, and of watts; none but W alone has a hundredth."""
    word, size = SIZES[prefix]
    for name in (f"{prefix}m", *(f"{word}{end}" for end in ("meter", "meters", "metre", "metres"))):
        assert radiance_unit(f"W/{name}^2/sr").factor == pytest.approx(size**-2, rel=1e-11)
        if prefix != "k":  # no wavelength
            unit = radiance_unit(f"W/m2/sr/{name}")
            assert unit.factor == unit.per_um == pytest.approx(1e-6 / size, rel=1e-11)
            assert unit.integrated.factor == 1.0
    if prefix != "c":
        for name in (f"{prefix}W", f"{word}watt", f"{word}Watts"):
            assert radiance_unit(f"{name}/m2/sr").factor == pytest.approx(size, rel=1e-11)


def test_words_of_their_own():
    for name, per_um in (("micron", 1.0), ("microns", 1.0), ("angstrom", 1e4), ("angstroms", 1e4)):
        assert radiance_unit(f"W/m2/sr/{name}").per_um == pytest.approx(per_um)
    for name in ("photon", "photons", "ph", "phot"):
        for second in ("s", "sec", "second", "seconds"):
            unit = radiance_unit(f"{name}/{second}/m2/steradian")
            assert (unit.factor, unit.photons, unit.spectral) == (1.0, True, "")
    assert radiance_unit("pW/m2/ster").factor == 1e-12
