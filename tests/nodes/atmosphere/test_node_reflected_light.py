"""Reflected Light: radiance of reflectances, in one band, in many, and of a cube."""

import math

import numpy as np
import pytest

from core.errors import ImagechainError
from core.evaluation.work import Policy
from cube_files import centres, write_cube
from node_bench import NodeBench
from planck_truth import band_radiance

SHARES = np.array([[0.0, 0.2, 0.5], [0.7, 1.0, 0.31]])
VISIBLE = {"cut_on_um": 0.5, "cut_off_um": 0.9}
SUN_SR = math.pi * (6.957e8 / 1.495978707e11) ** 2


@pytest.fixture
def lit(tmp_path):
    def made(params, *, samples=SHARES, read=None):
        np.save(tmp_path / "share.npy", samples)
        read = {"path": "share.npy", "unit": "1", **VISIBLE, **(read or {})}
        nodes = {"read": ("read_image", read), "light": ("reflected_light", params)}
        return NodeBench(tmp_path, nodes)

    return made


def warned(bench):
    return [str(one) for one in bench.warnings() if one.node == "light"]


def test_a_number(lit):
    """ρ·(900·sin 30° + π·20)·0.4 µm/π."""
    bench = lit({"solar_irradiance": 900, "sun_elevation_deg": 30, "sky": 20})
    assert bench.plan.errors() == []
    expected = SHARES * (450 + math.pi * 20) * 0.4 / math.pi
    np.testing.assert_allclose(bench.value("light.image"), expected, rtol=1e-13)
    image = bench.port("light.image")
    assert (image.unit, image.band_um, image.bands) == ("W/m²/sr", (0.5, 0.9), None)
    assert bench.readouts("light")["irradiance"] == pytest.approx(
        (450 + math.pi * 20) * 0.4, rel=1e-13
    )


def test_the_sun_as_a_black_body_and_a_unit_of_percent(lit):
    bench = lit(
        {"sun_elevation_deg": 90, "sun": "black_body"}, samples=100 * SHARES, read={"unit": "%"}
    )
    expected = SHARES * SUN_SR * band_radiance(0.5, 0.9, 5800) / math.pi
    np.testing.assert_allclose(bench.value("light.image"), expected, rtol=1e-12)


@pytest.mark.parametrize("unit", ["1", "reflectance", "Albedo"])
def test_units_of_reflectance(lit, unit):
    bench = lit({"solar_irradiance": 900}, read={"unit": unit})
    assert bench.plan.errors() == []


def test_bands_of_grey_surfaces(lit, tmp_path):
    """Eight bands have the mean irradiance of each, and their sum is that of the whole band."""
    (tmp_path / "sun.csv").write_text("um,irradiance\n0.4,1000\n1.0,1600\n")
    bench = lit({"path": "sun.csv", "sun_elevation_deg": 90, "bands": 8})
    image = bench.port("light.image")
    middles, width = centres(8, low=0.5, high=0.9)
    np.testing.assert_allclose(image.bands.centres_um, middles, rtol=1e-12)
    np.testing.assert_allclose(image.bands.widths_um, width, rtol=1e-12)
    whole = SHARES * 0.4 * 1300 / math.pi  # 1300 W/m²/µm at the band's middle
    np.testing.assert_allclose(bench.value("light.image"), whole, rtol=1e-12)
    for index, middle in enumerate(middles):
        one = bench.work.value(image.bands.band(index))
        expected = SHARES * (1000 + 1000 * (middle - 0.4)) / math.pi
        np.testing.assert_allclose(one, expected, rtol=1e-12, atol=1e-12)
    sums = bench.work.value(image.bands.sums(((1.0,) * 8, image.bands.whole)))
    np.testing.assert_allclose(sums[1], whole, rtol=1e-12)
    means = bench.work.value(image.bands.means())
    assert means @ image.bands.whole == pytest.approx(whole.mean(), rel=1e-12)
    light = (1000 + 1000 * (middles - 0.4)) / math.pi
    seen = bench.work.value(image.bands.spectrum(1, 0))
    np.testing.assert_allclose(seen, 0.7 * light, rtol=1e-12)
    seen = bench.work.value(image.bands.spectrum(0, 1, rows=2, columns=2))
    np.testing.assert_allclose(seen, (0.2 + 0.5 + 1.0 + 0.31) / 4 * light, rtol=1e-12)


def test_a_cube_of_reflectances(tmp_path):
    wavelengths, width = centres(6, low=0.5, high=0.8)
    cube = np.random.default_rng(5).uniform(0, 1, (6, 4, 5))
    write_cube(tmp_path, cube, wavelengths, width, unit="reflectance")
    nodes = {
        "read": ("read_image", {"path": "cube.img", "bands": "all"}),
        "light": ("reflected_light", {"sun_elevation_deg": 50, "bands": 9, "sun": "black_body"}),
    }
    bench = NodeBench(tmp_path, nodes)
    assert bench.plan.errors() == []
    share = SUN_SR * math.sin(math.radians(50)) / math.pi
    light = [band_radiance(one - width / 2, one + width / 2, 5800) for one in wavelengths]
    expected = share * np.tensordot(light, cube, 1)
    seen = bench.engine.value(bench.plan, "light.image", bench.engine.work(Policy("double")))
    np.testing.assert_allclose(seen, expected, rtol=1e-11)
    assert bench.port("light.image").bands.density
    assert "the picture already has 6 bands, which replace bands" in warned(bench)[0]


@pytest.mark.parametrize(
    ("params", "read", "words"),
    [
        ({}, {"unit": "W/m²/sr"}, ("'W/m²/sr'", "already radiance", "reflectance")),
        ({}, {"unit": "K"}, ("'K'", "a temperature")),
        ({}, {"unit": "DN"}, ("'DN'", "not a reflectance")),
        ({}, {"cut_on_um": None, "cut_off_um": None}, ("cut_on_um", "the image has no band")),
        ({"cut_on_um": 1.2}, {}, ("cut_off_um = 0.9", "above cut_on_um = 1.2")),
        ({"illuminance_lux": 0}, {}, ("illuminance_lux = 0", "above 0 to 1e+09 or empty")),
        ({"sun_elevation_deg": 95}, {}, ("sun_elevation_deg = 95", "from 0 to 90")),
        ({"path": "sun.csv"}, {}, ("0.6 to 1 µm", "Give a table that covers 0.5 to 0.9 µm")),
    ],
)
def test_bad_input_is_one_clear_line(lit, tmp_path, params, read, words):
    (tmp_path / "sun.csv").write_text("0.6,1000\n1.0,1600\n")
    try:
        (error,) = lit(params, read=read).plan.errors()
    except ImagechainError as refused:
        error = refused
    for word in words:
        assert word in str(error)
    assert "\n" not in str(error)


def test_reflectances_that_are_none(lit):
    bench = lit({}, samples=SHARES - 0.1)
    with pytest.raises(ImagechainError, match=r"reflectance: the smallest sample is -0.1"):
        bench.value("light.image")
    (text,) = warned(lit({}, samples=100 * SHARES))
    assert "samples reach a reflectance of 100" in text
    assert "look like percentages" in text
    assert warned(lit({})) == []


def test_an_illuminance_scales_the_light_and_starlight_is_warned_of(lit):
    """ρ·E·0.4 µm/π of a flat spectrum, whose lux are 683·0.106857 µm·E."""
    flat = {"solar_irradiance": 900, "sun_elevation_deg": 90}
    bench = lit({**flat, "illuminance_lux": 0.1})
    spectral = 0.1 / (683 * 0.106857)
    np.testing.assert_allclose(
        bench.value("light.image"), SHARES * spectral * 0.4 / math.pi, rtol=1e-5
    )
    assert bench.readouts("light")["illuminance"] == 0.1
    assert lit(flat).readouts("light")["illuminance"] == pytest.approx(
        900 * 683 * 0.106857, rel=1e-5
    )
    assert warned(bench) == []
    (said,) = warned(lit({"illuminance_lux": 0.001}))
    assert "at 0.001 lx (starlight)" in said
