"""Transmission and path radiance of air, by wavelength, band and range, against quadrature."""

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.physics.atmosphere.air_path import (
    SUN_SR,
    AirPath,
    Sunlight,
    band_nodes,
    extinction_of_visibility,
    luminous_efficiency,
    relative_air_mass,
    standard_sun_irradiance,
    transmission_at_ranges,
)
from planck_truth import band_radiance

C2_UM_K = mpmath.mpf("14387.768775039338")  # hc/k
C1_W_UM4 = mpmath.mpf("1.191042972397188e8")  # 2hc², W µm⁴/m²/sr


def planck(um, kelvin):
    """W/m²/sr/µm."""
    return C1_W_UM4 / um**5 / mpmath.expm1(C2_UM_K / (um * kelvin))


def planck_slope(um, kelvin):
    x = C2_UM_K / (um * kelvin)
    return planck(um, kelvin) * x / kelvin / -mpmath.expm1(-x)


def mean(function, weight, breaks):
    top = mpmath.quad(lambda um: function(um) * weight(um), breaks)
    return float(top / mpmath.quad(weight, breaks))


@pytest.mark.thorough(but=5)
@pytest.mark.parametrize(("low", "high", "source_K"), [(0.4, 0.9, 5800), (3, 5, 300), (8, 12, 250)])
@pytest.mark.parametrize("q", [0.6, 1.3, -1.0])
def test_a_haze_weighted_by_a_black_body(low, high, source_K, q):
    """τ = exp(−3.912/V·(0.55/λ)^q·R), over the band by mpmath; the air emits 1 − τ."""
    air = AirPath(
        extinction_per_km=3.912 / 9, angstrom_q=q, range_m=4000, air_K=283 if low > 2 else None
    )

    def passed(um):
        return mpmath.exp(-mpmath.mpf("3.912") / 9 * 4 * (mpmath.mpf("0.55") / um) ** q)

    breaks = mpmath.linspace(low, high, 9)
    transmission, radiance = air.over_band(low, high, source_K=source_K)
    truth = mean(passed, lambda um: planck(um, source_K), breaks)
    assert transmission == pytest.approx(truth, rel=1e-12)
    added = 0 if low < 2 else mpmath.quad(lambda um: (1 - passed(um)) * planck(um, 283), breaks)
    assert radiance == pytest.approx(float(added), rel=1e-12)


def test_a_table_is_straight_between_its_points():
    points = ((2.9, 0.2), (3.4, 0.8), (3.9, 0.1), (4.4, 0.0), (5.5, 0.6))
    radiance = ((2.0, 0.1), (4.1, 0.3), (6.0, 0.2))
    air = AirPath(points=points, radiance=radiance, range_m=2000)

    def line(table, um):
        (x0, y0), (x1, y1) = next((a, b) for a, b in pairwise(table) if a[0] <= um <= b[0])
        return y0 + (y1 - y0) * (um - x0) / (x1 - x0)

    breaks = [3, 3.4, 3.9, 4.1, 4.4, 5]
    transmission, added = air.over_band(3, 5, source_K=290)
    truth = mean(lambda um: line(points, um), lambda um: planck(um, 290), breaks)
    assert transmission == pytest.approx(truth, rel=1e-12)
    truth = mpmath.quad(lambda um: line(radiance, um), breaks)
    assert added == pytest.approx(float(truth), rel=1e-12)
    cut = air.within_band(3.5, 4.0)
    assert cut.points == points[1:4]
    assert cut.over_band(3.5, 4.0, source_K=290) == air.over_band(3.5, 4.0, source_K=290)


@pytest.mark.parametrize("range_m", [0.0, 500.0, 3000.0, 40000.0])
def test_ranges_by_wavelength(range_m):
    """Each wavelength by Beer's law, two constituents, weighted by ∂L/∂T; not the band's mean."""
    points = ((7.0, 0.9), (9.0, 0.5), (13.0, 0.7))
    gas = AirPath(points=points, range_m=1000)
    haze = AirPath(extinction_per_km=0.3, angstrom_q=0.8, range_m=77)

    def passed(um):
        low, high = (points[0], points[1]) if um < 9 else (points[1], points[2])
        tau = low[1] + (high[1] - low[1]) * (um - low[0]) / (high[0] - low[0])
        beta = mpmath.mpf("0.3") * (mpmath.mpf("0.55") / um) ** mpmath.mpf("0.8")
        return tau ** (mpmath.mpf(range_m) / 1000) * mpmath.exp(-beta * range_m / 1000)

    truth = mean(passed, lambda um: planck_slope(um, 295), [8, 8.5, 9, 10, 11, 12])
    left = transmission_at_ranges(
        paths=(gas, haze), range_m=[range_m], cut_on_um=8, cut_off_um=12, background_K=295
    )
    assert left == pytest.approx([truth], rel=1e-11)


def test_grey_air_follows_beer_and_nothing_passes_an_opaque_one():
    band = {"cut_on_um": 8.0, "cut_off_um": 12.0, "background_K": 300.0}
    grey = (AirPath(transmission=0.6, range_m=2000), AirPath(extinction_per_km=0.1, range_m=5))
    left = transmission_at_ranges(paths=grey, range_m=np.array([0.0, 2000.0, 6000.0]), **band)
    expected = [1.0, 0.6 * math.exp(-0.2), 0.6**3 * math.exp(-0.6)]
    assert left == pytest.approx(expected, rel=1e-14)
    opaque = (AirPath(transmission=0.0, range_m=10),)
    left = transmission_at_ranges(paths=opaque, range_m=np.array([0.0, 1e-3, 5.0]), **band)
    assert left.tolist() == [1.0, 0.0, 0.0]
    fog = (AirPath(extinction_per_km=1e300, range_m=1.0),)
    with np.errstate(all="raise"):
        assert transmission_at_ranges(paths=fog, range_m=1e9, **band) == 0.0
    half = (AirPath(points=((7, 0.0), (10, 0.0), (10.0001, 1.0), (13, 1.0)), range_m=10),)
    assert 0.4 < transmission_at_ranges(paths=half, range_m=1e9, **band) < 0.6


def test_what_cannot_be_summed():
    with pytest.raises(ParameterError, match="visibility_km = 0"):
        extinction_of_visibility(visibility_km=0)
    short = AirPath(points=((8.5, 0.5), (13, 0.5)))
    with pytest.raises(DataError, match=r"8.5 to 13 µm.*Give a table that covers 8 to 12 µm"):
        short.over_band(8, 12, source_K=300)
    haze = AirPath(extinction_per_km=1.0, angstrom_q=1.0, range_m=1.0)
    with pytest.raises(DataError, match=r"emits nothing from 0.4 to 0.7"):
        haze.over_band(0.4, 0.7, source_K=3.0)
    with pytest.raises(ParameterError, match="range_m is empty"):
        transmission_at_ranges(
            paths=(AirPath(transmission=0.5),), range_m=1.0, cut_on_um=8, cut_off_um=12,
            background_K=300,
        )  # fmt: skip
    with pytest.raises(ParameterError, match="cut_off_um = 3"):
        band_nodes(3.0, 3.0, ())


# Sun and sky on a surface: air mass, a black body's irradiance, tables, against quadrature.


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
        (Sunlight(0, **lux), "no light reaches the ground with the sun on the horizon and sky = 0"),
        (Sunlight(9, irradiance=0, **lux), "the spectrum has no light from 0.38"),
        (Sunlight(9, points=infrared, **lux), "the spectrum must cover 0.38"),
    ):
        with pytest.raises(ParameterError, match=f"illuminance_lux = 1.0 lx is not allowed: {why}"):
            dark.over_band(0.9, 1.7)
