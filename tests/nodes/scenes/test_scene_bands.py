"""Scenes in bands: sums of bands against bands, their integral, and surfaces by hand."""

import numpy as np
import pytest

from core.evaluation.work import Policy
from node_bench import NodeBench
from nodes.scenes import draw
from nodes.scenes.draw import KINDS, SHADED, SKY, SURFACES, materials, scene_spectra
from planck_truth import band_radiance

DOUBLE = Policy("double", 0.0)
SIZE = {"width": 83, "height": 61}
LIGHT = {"temperature_K": 293.15, "delta_K": 6.0}


def scene(folder, policy=DOUBLE, **parameters):
    values = {"cut_on_um": 3.4, "cut_off_um": 5.0, **SIZE, **LIGHT, **parameters}
    bench = NodeBench(folder, {"scene": ("test_scene", values)}, [])
    return bench.port("scene.image"), bench.engine.work(policy)


@pytest.mark.parametrize("at_once", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_a_sum_is_that_of_its_bands_and_means_are_theirs(tmp_path, monkeypatch, kind, at_once):
    monkeypatch.setattr(draw, "MOST_SAMPLES", 0 if at_once else 10**9)
    made, work = scene(tmp_path, kind=kind, bands=5, sun_elevation_deg=40.0)
    weights = ((0.3, 0.0, 2.0, -1.0, 0.25), (1.0, 1.0, 0.5, 0.0, 0.0))
    cube = np.stack([work.value(made.bands.band(index)) for index in range(5)])
    sums = work.value(made.bands.sums(weights))
    np.testing.assert_allclose(sums, np.tensordot(weights, cube, 1), atol=1e-13 * cube.max())
    np.testing.assert_allclose(work.value(made.bands.means()), cube.mean(axis=(1, 2)), rtol=1e-12)


def spectra(low, high, bands=1, **parameters):
    values = {"emissivity": "spectra", "sun_elevation_deg": 0.0, **LIGHT, **parameters}
    return scene_spectra(kind="dormitory", cut_on_um=low, cut_off_um=high, bands=bands, **values)


@pytest.mark.parametrize("name", ["brick", "lawn", "metal", "glass_lit", "shade", "horizon"])
def test_a_surface_by_hand_in_a_narrow_band(name):
    low, high = 4.0, 4.002
    offset, _, material = SURFACES[name]
    reflected = float(np.interp(4.001, *np.transpose(materials()[material])))
    sky_reflected = float(np.interp(4.001, *np.transpose(materials()["clear sky"])))
    sun = (
        np.sin(np.radians(35.0)) * (6.957e8 / 1.495978707e11) ** 2 * band_radiance(low, high, 5800)
    )
    sky = (1 - sky_reflected) * band_radiance(low, high, 293.15 - 2.6 * 6.0)
    sky = 0.0 if name in SKY else sky + sky_reflected * sun
    lit = 0.0 if name in SHADED else sun
    light = (1 - reflected) * band_radiance(low, high, 293.15 + offset * 6.0)
    light += reflected * (sky + lit)
    made = spectra(low, high, sun_elevation_deg=35.0)[name]
    assert made == pytest.approx([light / (high - low)], rel=1e-5)


def test_plants_are_bright_beyond_the_edge_and_the_ground_is_not():
    red, near = (
        spectra(low, high, sun_elevation_deg=50.0) for low, high in ((0.64, 0.68), (0.78, 0.9))
    )
    sun = 0.68 / 0.32  # sunlight falls between the two, by less than that
    for name, least, most in (("lawn", 4, 12), ("asphalt", 0.4, 1.2), ("water", 0.2, 0.9)):
        ratio = near[name][0] / red[name][0]
        assert least < ratio * sun / 2 < most, name


@pytest.mark.parametrize("kind", ["dormitory", "airfield"])
def test_reflectances_lit_by_the_sun_are_the_scene_in_the_sun(tmp_path, kind):
    """From 0.5 to 0.9 µm nothing of 300 K emits; 5800 K and 35° are lit here and there."""
    values = {"kind": kind, "cut_on_um": 0.5, "cut_off_um": 0.9, "bands": 4, **SIZE, **LIGHT}
    nodes = {
        "sunny": ("test_scene", {**values, "sun_elevation_deg": 35.0}),
        "share": ("test_scene", {**values, "quantity": "reflectance"}),
        "light": ("reflected_light", {"sun": "black_body", "sun_elevation_deg": 35.0}),
    }
    bench = NodeBench(tmp_path, nodes, [("share.image", "light.image")])
    assert bench.port("share.image").unit == "1"
    assert 0.0 < bench.value("share.image").min() < bench.value("share.image").max() < 1.0
    lit, sunny = bench.port("light.image"), bench.port("sunny.image")
    for band in range(4):
        np.testing.assert_allclose(
            bench.work.value(lit.bands.band(band)),
            bench.work.value(sunny.bands.band(band)),
            rtol=1e-11,
        )


@pytest.mark.parametrize("bands", [0, 3])
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in draw.DRAWN])
def test_a_target_in_reflectance_is_the_black_one_between_other_levels(tmp_path, kind, bands):
    """Lit by 100 W/m²/µm from the zenith, over 4 µm."""
    ends = {"cut_on_um": 8.0, "cut_off_um": 12.0}
    values = {"kind": kind, **ends, **SIZE, "temperature_K": 290.0, "delta_K": 20.0}
    levels = {"background_reflectance": 0.2, "target_reflectance": 0.9}
    share = {**values, **levels, "quantity": "reflectance", "bands": bands}
    nodes = {
        "black": ("test_scene", values),
        "share": ("test_scene", share),
        "light": ("reflected_light", {"solar_irradiance": 100.0, "sun_elevation_deg": 90.0}),
    }
    bench = NodeBench(tmp_path, nodes, [("share.image", "light.image")])
    cold, warm = (band_radiance(8.0, 12.0, kelvin) for kelvin in (290.0, 310.0))
    signal = (bench.value("black.image") - cold) / (warm - cold)
    want = (0.2 + 0.7 * signal) * 400.0 / np.pi
    np.testing.assert_allclose(bench.value("light.image"), want, rtol=1e-9)


def test_drawn_scenes_without_bands_have_no_reflectance(tmp_path):
    values = {"scene": ("test_scene", {"kind": "dormitory", "quantity": "reflectance"})}
    bench = NodeBench(tmp_path, values, [])
    assert "bands = 0 is not allowed: must be 1 or more for the dormitory" in str(
        bench.error("scene")
    )
