"""Sun and sky on a surface: air mass, a black body's irradiance, tables, against quadrature."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.atmosphere.air_path import (
    SUN_SR,
    Sunlight,
    luminous_efficiency,
    relative_air_mass,
    standard_sun_irradiance,
)
from planck_truth import band_radiance


def test_air_mass():
    """Kasten and Young's own table: 1 at the zenith, 5.59 at 10°, 10.31 at 5°, 37.92 at 0."""
    assert relative_air_mass(elevation_deg=90) == pytest.approx(1.0, rel=4e-4)
    for elevation, published in ((30, 1.9942), (10, 5.5841), (5, 10.3164), (0, 37.9196)):
        assert relative_air_mass(elevation_deg=elevation) == pytest.approx(published, rel=2e-3)
    assert relative_air_mass(elevation_deg=60) == pytest.approx(2 / math.sqrt(3), rel=2e-3)


def test_the_sun_at_all_wavelengths():
    """σT⁴·(R/d)² = 1388 W/m²."""
    whole = 5.670374419e-8 * 5800**4 * (6.957e8 / 1.495978707e11) ** 2
    assert whole == pytest.approx(1387.8, abs=0.1)
    assert Sunlight(90, standard=False).over_band(0.05, 500) == pytest.approx(whole, rel=1e-6)
    assert pytest.approx(6.794e-5, rel=1e-4) == SUN_SR


def test_the_standard_spectrum():
    """Of Gueymard's 1366.1 W/m² 1.0 % lie below 0.28 µm (ASTM E490: 0.6 %) and beyond 4 µm."""
    whole = Sunlight(90).over_band(0.28, 4.0)
    assert whole == pytest.approx(1347.9, abs=0.1)  # NREL's own sum of the column
    assert 0.98 < whole / 1366.1 < 0.99
    # the photosphere is seen deepest near 1.6 µm, where a black body of 5800 K is 16 % too low
    black = float(SUN_SR * mpmath.mpf(band_radiance(1.6, 1.62, 5800)))
    assert Sunlight(90).over_band(1.6, 1.62) / black == pytest.approx(1.196, abs=0.001)
    # two lines of the printed table: 0.28 µm 0.082 and 4 µm 0.00868 W/m²/nm
    assert standard_sun_irradiance([0.28, 4.0]).tolist() == [82.0, 8.68]


def test_the_standard_spectrum_goes_on_as_a_black_body():
    at, on = standard_sun_irradiance([4.0, 10.0])
    ratio = band_radiance(9.99, 10.01, 5800) / band_radiance(3.99, 4.01, 5800)
    assert on / at == pytest.approx(ratio, rel=1e-4)
    with pytest.raises(ParameterError, match=r"at least 0.28, where the standard solar spectrum"):
        Sunlight(30).over_band(0.2, 0.4)


def test_a_black_body_in_a_band():
    """Ω·L(5800 K)·exp(−0.3·m)·sin 40° + π·12·0.4, the band's radiance by mpmath."""
    light = Sunlight(40, standard=False, sky=12.0, optical_depth=0.3)
    passed = math.exp(-0.3 * relative_air_mass(elevation_deg=40))
    direct = SUN_SR * band_radiance(0.5, 0.9, 5800) * passed * math.sin(math.radians(40))
    assert light.over_band(0.5, 0.9) == pytest.approx(direct + math.pi * 12 * 0.4, rel=1e-12)


def test_a_table_and_a_number():
    points = ((0.4, 1000.0), (0.55, 1800.0), (0.8, 1200.0))
    light = Sunlight(30, points=points)

    def line(um):
        low, high = (points[0], points[1]) if um < 0.55 else (points[1], points[2])
        return low[1] + (high[1] - low[1]) * (um - low[0]) / (high[0] - low[0])

    expected = float(mpmath.quad(line, [0.45, 0.55, 0.7])) / 2
    assert light.over_band(0.45, 0.7) == pytest.approx(expected, rel=1e-13)
    assert Sunlight(30, irradiance=900.0).over_band(0.4, 0.6) == pytest.approx(90.0, rel=1e-13)
    assert Sunlight(0, irradiance=900.0).over_band(0.4, 0.6) == 0.0


def test_the_eye_sees_the_published_sum_peak_and_freezing_platinum():
    """ΣV·5 nm is 106.857 nm; at 2042.15 K (IPTS-68) platinum has 60 cd/cm²: 683 comes from it."""
    places = np.arange(380, 781, 5) / 1000
    assert luminous_efficiency(places).sum() * 5 == pytest.approx(106.857, abs=1e-3)
    assert luminous_efficiency([0.3799, 0.555, 0.7801]).tolist() == [0.0, 1.0, 0.0]
    fine = np.linspace(0.38, 0.78, 4001)
    light = 119104297.2 / fine**5 / np.expm1(14387.7688 / fine / 2042.15)  # W/m²/sr/µm
    candela = 683 * np.trapezoid(light * luminous_efficiency(fine), fine)
    assert candela == pytest.approx(60e4, rel=3e-3)


def test_the_solar_illuminance_and_what_it_is_scaled_to():
    """133.1 klx above the air (Darula, Kittler, Gueymard 2005); the spectrum keeps its shape."""
    assert Sunlight(90).unscaled_lux == pytest.approx(133.1e3, rel=3e-3)
    full, moon = Sunlight(40, sky=7.0), Sunlight(40, sky=7.0, illuminance_lux=0.1)
    scale = 0.1 / full.unscaled_lux
    assert moon.over_band(0.9, 1.7) == pytest.approx(scale * full.over_band(0.9, 1.7), rel=1e-13)
    flat = Sunlight(90, irradiance=2.0, illuminance_lux=1000.0)  # ∫V dλ = 0.106857 µm
    assert flat.over_band(1.0, 2.0) == pytest.approx(1000 / 683 / 0.106857, rel=1e-5)
    infrared = ((0.9, 1.0), (1.7, 1.0))
    lux = {"illuminance_lux": 1.0}
    for dark, why in (
        (Sunlight(0, **lux), "the sun is on the horizon and sky is 0"),
        (Sunlight(9, irradiance=0, **lux), "the spectrum has no light from 0.38"),
        (Sunlight(9, points=infrared, **lux), "the spectrum must cover 0.38"),
    ):
        with pytest.raises(ParameterError, match=f"illuminance_lux = 1.0 lx is not allowed: {why}"):
            dark.over_band(0.9, 1.7)
