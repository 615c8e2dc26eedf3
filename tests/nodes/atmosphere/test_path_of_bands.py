"""Atmospheric Path on a cube: each band by its own transmission, through optics and to the sum."""

import mpmath
import numpy as np
import pytest
import scipy.fft

from core.evaluation.work import Policy
from cube_files import C1_UM, C2_UM, band_by_band, centres, materials_cube, write_cube
from node_bench import NodeBench, fov_of
from nodes.analysis.lineage import transfer_of

SIZE, COUNT, INTERVAL = (32, 40), 24, 0.035
HAZE = {
    "model": "visibility_km", "visibility_km": 2.0, "angstrom_q": 1.3, "range_m": 3000.0,
    "air_K": 285.0,
}  # fmt: skip


def passed(um):
    """exp(−3.912/2 km·3 km·(0.55/λ)^1.3)."""
    power = mpmath.mpf("1.3")
    return mpmath.exp(-mpmath.mpf("3.912") / 2 * 3 * (mpmath.mpf("0.55") / um) ** power)


def emitted(um):
    return (1 - passed(um)) * C1_UM / um**5 / mpmath.expm1(C2_UM / um / 285)


def over(function, wavelengths, width):
    """Mean over each band."""
    halves = [(float(one - width / 2), float(one + width / 2)) for one in wavelengths]
    return np.array([float(mpmath.quad(function, ends)) / width for ends in halves])


@pytest.fixture
def chain(tmp_path):
    wavelengths, width = centres(COUNT)
    cube = materials_cube(SIZE, wavelengths)
    write_cube(tmp_path, cube, wavelengths, width)

    def made(params, *, bands="all"):
        nodes = {
            "read": ("read_image", {"path": "cube.img", "bands": bands, **fov_of(SIZE, INTERVAL)}),
            "air": ("atmospheric_path", params),
            "init": ("init_trans", {"focal_length_mm": 100.0, "f_number": 1.0}),
            "optics": ("diffraction_mtf", {"aperture_mm": 100.0}),
            "back": ("back_transform", {}),
        }
        bench = NodeBench(tmp_path, nodes)
        assert bench.plan.errors() == []
        return bench, bench.engine.work(Policy("double", 0.0))

    return made, cube, wavelengths, width


def test_each_band_has_its_own_transmission(chain):
    made, cube, wavelengths, width = chain
    bench, work = made(HAZE)
    gain = over(passed, wavelengths, width)
    added = over(emitted, wavelengths, width)
    assert gain[-1] - gain[0] > 0.1
    seen = bench.engine.value(bench.plan, "air.image", work)
    expected = width * (np.tensordot(gain, cube, 1) + added.sum())
    np.testing.assert_allclose(seen, expected, rtol=1e-11)
    figures = bench.engine.readouts(bench.plan, "air", work)
    light = cube.mean(axis=(1, 2))
    assert figures["transmission"] == pytest.approx(gain @ light / light.sum(), rel=1e-11)
    assert figures["path_radiance"] == pytest.approx(width * added.sum(), rel=1e-11)
    bands = bench.plan.output("air.image").bands
    one = work.value(bands.band(5))
    np.testing.assert_allclose(one, gain[5] * cube[5] + added[5], rtol=1e-11)


def test_optics_blur_each_band_behind_the_path(chain):
    """The sum of bands that are dimmed, blurred at their own wavelength, and summed; by hand."""
    made, cube, wavelengths, width = chain
    bench, work = made(HAZE)
    gain = over(passed, wavelengths, width)
    blurred = band_by_band(
        cube, wavelengths, width * gain, interval_mrad=INTERVAL, aperture_mm=100.0
    )
    expected = blurred + width * over(emitted, wavelengths, width).sum()
    seen = bench.engine.value(bench.plan, "back.image", work)
    assert np.abs(seen - expected).max() <= 1e-11 * np.ptp(expected)
    assert len(bench.plan.output("back.image").air) == 1


def test_what_the_air_adds_is_no_signal(chain):
    """The level of the chain is the scene's share of the mean, and gains count behind the air."""
    made, cube, wavelengths, width = chain
    bench, work = made(HAZE)
    image = bench.plan.output("back.image")
    (level,) = transfer_of(image).levels
    expected = width * np.tensordot(over(passed, wavelengths, width), cube, 1).mean()
    assert work.value(level).signal == pytest.approx(expected, rel=1e-11)
    of_camera = transfer_of(image, of_camera=True)
    assert (of_camera.levels, of_camera.gain) == ((), 1.0)


def test_grey_air_is_a_number_and_clear_air_nothing(chain):
    made, cube, _, width = chain
    bench, work = made({"transmission": 0.7})
    seen = bench.engine.value(bench.plan, "air.image", work)
    np.testing.assert_allclose(seen, 0.7 * width * cube.sum(axis=0), rtol=1e-12)
    bench, _ = made({"air_K": 300})
    assert bench.plan.output("air.image").key == bench.plan.output("read.image").key
    assert bench.plan.output("air.image").bands == bench.plan.output("read.image").bands


def turbulent(frequency, um, r0_mm_at_4um):
    """Fried 1966, long exposure: exp(−3.44·(λρ/r0)^(5/3)), r0 as λ^(6/5)."""
    return np.exp(-3.44 * (um * frequency / (r0_mm_at_4um * (um / 4) ** 1.2)) ** (5 / 3))


def hazy(frequency, um, radius_um):
    """Kopeika 1998: exp(−0.7·(ρ/ρc)²), the plateau from ρc = a/λ on."""
    return np.exp(-0.7 * np.minimum(frequency * um * 1000 / radius_um, 1.0) ** 2)


@pytest.mark.parametrize(
    ("params", "otf"),
    [
        ({"turbulence": "long_exposure", "fried_r0_m": 0.03},
         lambda rho, um: turbulent(rho, um, 30.0)),
        ({"turbulence": "none", "turbidity": "custom", "scatter_depth": 0.7,
          "particle_radius_um": 30000.0}, lambda rho, um: hazy(rho, um, 30000.0)),
    ],
)  # fmt: skip
def test_air_blurs_each_band_at_its_own_wavelength(tmp_path, params, otf):
    wavelengths, width = centres(COUNT)
    cube = materials_cube(SIZE, wavelengths)
    write_cube(tmp_path, cube, wavelengths, width)
    nodes = {
        "read": ("read_image", {"path": "cube.img", "bands": "all", **fov_of(SIZE, INTERVAL)}),
        "init": ("init_trans", {}),
        "blur": ("atmosphere_mtf", params),
        "back": ("back_transform", {}),
    }
    bench = NodeBench(tmp_path, nodes)
    assert bench.plan.errors() == []
    rho = np.hypot(
        np.arange(SIZE[1]) / (2 * SIZE[1] * INTERVAL),
        np.arange(SIZE[0])[:, np.newaxis] / (2 * SIZE[0] * INTERVAL),
    )
    expected = sum(
        width * scipy.fft.idctn(scipy.fft.dctn(band) * otf(rho, um))
        for band, um in zip(cube, wavelengths, strict=True)
    )
    made = bench.engine.value(bench.plan, "back.image", bench.engine.work(Policy("double", 0.0)))
    assert np.abs(made - expected).max() <= 1e-11 * np.ptp(expected)
    middle = width * sum(scipy.fft.idctn(scipy.fft.dctn(band) * otf(rho, 4.0)) for band in cube)
    assert np.abs(made - middle).max() > 1e-4 * np.ptp(expected)
