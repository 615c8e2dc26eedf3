"""Transmission and path radiance of air, by wavelength, band and range, against quadrature."""

from __future__ import annotations

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest

from core.errors import DataError, ParameterError
from core.physics.atmosphere.air_path import (
    AirPath,
    band_nodes,
    extinction_of_visibility,
    transmission_at_ranges,
)
from reference_cases import CAMERA, reference_cases

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


@pytest.mark.parametrize("case", reference_cases("transmission", file=CAMERA))
def test_published_transmissions(case):
    inputs = case["inputs"]
    extinction = extinction_of_visibility(visibility_km=float(inputs["visibility_km"]))
    air = AirPath(extinction_per_km=extinction, range_m=1000 * float(inputs["range_km"]))
    band = air.over_band(0.4, 0.7, source_K=5800)
    assert band.transmission == pytest.approx(float(case["expected"]["transmission"]), rel=1e-12)
    assert band.path_radiance == 0.0


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
    band = air.over_band(low, high, source_K=source_K)
    truth = mean(passed, lambda um: planck(um, source_K), breaks)
    assert band.transmission == pytest.approx(truth, rel=1e-12)
    added = 0 if low < 2 else mpmath.quad(lambda um: (1 - passed(um)) * planck(um, 283), breaks)
    assert band.path_radiance == pytest.approx(float(added), rel=1e-12)


def test_a_table_is_straight_between_its_points():
    points = ((2.9, 0.2), (3.4, 0.8), (3.9, 0.1), (4.4, 0.0), (5.5, 0.6))
    radiance = ((2.0, 0.1), (4.1, 0.3), (6.0, 0.2))
    air = AirPath(points=points, radiance=radiance, range_m=2000)

    def line(table, um):
        (x0, y0), (x1, y1) = next((a, b) for a, b in pairwise(table) if a[0] <= um <= b[0])
        return y0 + (y1 - y0) * (um - x0) / (x1 - x0)

    breaks = [3, 3.4, 3.9, 4.1, 4.4, 5]
    band = air.over_band(3, 5, source_K=290)
    truth = mean(lambda um: line(points, um), lambda um: planck(um, 290), breaks)
    assert band.transmission == pytest.approx(truth, rel=1e-12)
    truth = mpmath.quad(lambda um: line(radiance, um), breaks)
    assert band.path_radiance == pytest.approx(float(truth), rel=1e-12)
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
    with pytest.raises(DataError, match=r"8.5 to 13 µm.*give a table that covers 8 to 12 µm"):
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
