"""Field PSF against sums in which every sample has a PSF of its own, worked out here."""

import math

import numpy as np
import pytest
import scipy.fft
import scipy.ndimage

from core.chain.step_lineage import lineage_of
from core.errors import ParameterError
from core.transfer.factors import factor_at
from field_bench import assert_same_in_blocks, cube_bench, field_bench
from node_bench import NodeBench

STEP = 0.1  # mrad
SIZE = (150, 170)
FAR = 40  # samples to which PSFs are summed


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A real scene, with its roofs, windows and trees."""
    params = {"kind": "dormitory", "height": SIZE[0], "width": SIZE[1]}
    nodes = {"scene": ("test_scene", params)}
    return NodeBench(tmp_path_factory.mktemp("scene"), nodes).value("scene.image")


def place_of(row, column):
    """Share of the half diagonal, and direction: right of the axis, and down."""
    x, y = column - (SIZE[1] - 1) / 2, row - (SIZE[0] - 1) / 2
    r = math.hypot(x, y)
    return 2 * r / math.hypot(*SIZE), (x / r, y / r)


def between(position, positions, values):
    return np.interp(position**2, np.square(positions), values)


def own_sums(picture, psf_of, places, far=FAR):
    """Σ of mirrored samples times the PSF of the place; PSFs by offsets right and down."""
    padded = np.pad(picture, far, mode="symmetric")
    d = np.arange(-far, far + 1) * STEP
    x, y = np.meshgrid(d, d)
    sums = []
    for row, column in places:
        weights = psf_of(*place_of(row, column), x, y)
        around = padded[row : row + 2 * far + 1, column : column + 2 * far + 1]
        sums.append(np.sum(around[::-1, ::-1] * weights) / weights.sum())
    return np.array(sums)


def gaussian(sigma_t, sigma_s, toward, x, y):
    t = x * toward[0] + y * toward[1]
    s = y * toward[0] - x * toward[1]
    return np.exp(-0.5 * ((t / sigma_t) ** 2 + (s / sigma_s) ** 2))


def places():
    generator = np.random.default_rng(4)
    corners = [(0, 0), (0, 169), (149, 0), (149, 169), (74, 84), (75, 85), (3, 80), (80, 2)]
    return [*corners, *zip(generator.integers(0, 150, 150), generator.integers(0, 170, 150),
                           strict=True)]  # fmt: skip


def worst_error(bench, scene, psf_of):
    """Largest error in percent of the scene's range, and the one that the module states."""
    at = places()
    found = bench.value("it.image")[tuple(np.transpose(at))]
    error = np.abs(found - own_sums(scene, psf_of, at)).max() / np.ptp(scene)
    return 100 * error, bench.readouts("it")["error_percent"]


@pytest.mark.parametrize("tile", [12, 32])
def test_gaussians_of_a_real_scene_within_the_stated_error(tmp_path, scene, tile):
    positions, tangential, sagittal = [0.0, 0.5, 1.0], [0.15, 0.2, 0.35], [0.15, 0.17, 0.22]
    params = {"positions": positions, "tangential_mrad": tangential, "sagittal_mrad": sagittal}
    bench = field_bench(tmp_path, scene, "field_psf", {**params, "tile": tile}, step_mrad=STEP)

    def psf(position, toward, x, y):
        widths = (between(position, positions, one) for one in (tangential, sagittal))
        return gaussian(*widths, toward, x, y)

    error, stated = worst_error(bench, scene, psf)
    assert error < {12: 0.1, 32: 0.4}[tile] < stated < {12: 0.9, 32: 3.0}[tile]


def test_files_of_mtf_within_the_stated_error(tmp_path, scene):
    """Exponentials, e^(−a·f) along the radius and e^(−b·f) across; here by a fine transform."""
    rates = [(0.3, 0.3), (0.4, 0.35), (0.8, 0.5)]
    f = np.linspace(0, 8, 400)
    for n, (a, b) in enumerate(rates, 1):
        rows = "\n".join(f"{v:.9g},{math.exp(-b * v):.12g},{math.exp(-a * v):.12g}" for v in f)
        (tmp_path / f"{n}.csv").write_text(f"frequency (cyc/mrad),mtf_x,mtf_y\n{rows}\n")
    params = {"kind": "mtf", "tile": 40, **{f"path_{n}": f"{n}.csv" for n in (1, 2, 3)}}
    bench = field_bench(tmp_path, scene, "field_psf", params, step_mrad=STEP)
    far = 300  # their tails fall slowly
    side = 2 * far + 1

    def psf(position, toward, x, y):
        xi, eta = np.meshgrid(*(2 * [scipy.fft.fftfreq(2 * side, STEP)]))
        t, s = np.abs(xi * toward[0] + eta * toward[1]), np.abs(eta * toward[0] - xi * toward[1])
        otfs = [np.exp(-a * t - b * s) for a, b in rates]
        shares = [between(position, [0, 0.5, 1], np.eye(3)[n]) for n in range(3)]
        whole = scipy.fft.fftshift(
            scipy.fft.ifft2(sum(p * h for p, h in zip(shares, otfs, strict=True))).real
        )
        return whole[side - far : side + far + 1, side - far : side + far + 1]

    at = places()[::8]
    found = bench.value("it.image")[tuple(np.transpose(at))]
    error = np.abs(found - own_sums(scene, psf, at, far)).max() / np.ptp(scene)
    assert 100 * error < 1.0 < bench.readouts("it")["error_percent"] < 20


def test_a_listing_of_zemax_has_all_positions(tmp_path):
    """Its tangential column is the one along the radius, at the axis along y."""
    fields = "".join(
        f"Field: {n} (deg)\nSpatial frequency    Tangential    Sagittal\n"
        f"0 1 1\n10 {t} {s}\n20 0.1 0.1\n"
        for n, (t, s) in enumerate(((0.8, 0.7), (0.3, 0.5)))
    )
    text = f"Spatial frequency units are cycles per mm\n{fields}"
    (tmp_path / "lens.txt").write_text(text)
    params = {"kind": "mtf", "path_1": "lens.txt", "positions": [0, 1], "tile": 16}
    camera = {"pitch_um": 10, "focal_length_mm": 100}
    picture = np.random.default_rng(0).random((40, 40))
    bench = field_bench(tmp_path, picture, "field_psf", params, step_mrad=STEP, camera=camera)
    spread = dict(bench.port("it.image").recipe.parameters)["spread"]
    f = np.array([1.0, 0.0]), np.array([0.0, 1.0])  # 10 cyc/mm are 1 cyc/mrad
    for knot, (t, s) in zip(spread.knots, ((0.8, 0.7), (0.3, 0.5)), strict=True):
        np.testing.assert_allclose(factor_at(bench.work, knot[0], *f), [s, t], rtol=1e-12)


def test_files_of_psf_turn_with_the_field(tmp_path, scene):
    """A spot with a tail away from the axis: up in the file, outwards in the picture."""

    def spot(up, right, tail):
        return gaussian(0.15, 0.15, (1, 0), up, right) + tail * gaussian(
            0.2, 0.15, (1, 0), up - 0.4, right)  # fmt: skip

    pitch = 0.05
    d = pitch * np.arange(-30, 31)
    for n, tail in enumerate((0.0, 0.2, 0.8), 1):
        np.save(tmp_path / f"{n}.npy", spot(-d[:, np.newaxis], d, tail))
    camera = {"pitch_um": 10, "focal_length_mm": 100}
    params = {"kind": "psf", "tile": 24, "sample_pitch_um": 100 * pitch,
              **{f"path_{n}": f"{n}.npy" for n in (1, 2, 3)}}  # fmt: skip
    bench = field_bench(tmp_path, scene, "field_psf", params, step_mrad=STEP, camera=camera)
    light = [spot(-d[:, np.newaxis], d, tail).sum() for tail in (0.0, 0.2, 0.8)]

    def psf(position, toward, x, y):
        up, right = x * toward[0] + y * toward[1], y * toward[0] - x * toward[1]
        shares = [between(position, [0, 0.5, 1], np.eye(3)[n]) for n in range(3)]
        return sum(share / all_of * spot(up, right, tail) for share, all_of, tail in
                   zip(shares, light, (0.0, 0.2, 0.8), strict=True))  # fmt: skip

    error, stated = worst_error(bench, scene, psf)
    assert error < 0.3 < stated < 2.5


def test_lineage_bands_blocks_and_a_uniform_field(tmp_path):
    params = {"tangential_mrad": [0.2, 0.3, 0.4], "tile": 20}
    picture = np.random.default_rng(2).random((90, 111))
    bench = field_bench(tmp_path, picture, "field_psf", params, step_mrad=STEP)
    change = lineage_of(bench.port("it.image").recipe).linear
    (factor,) = change.transfer(None, None, "it")
    f = np.linspace(0, 4, 9)
    axis = np.exp(-2 * np.pi**2 * 0.2**2 * f**2)
    np.testing.assert_allclose(factor_at(bench.work, factor, f, 0 * f), axis, rtol=1e-12)
    assert_same_in_blocks(bench, "it.image", tmp_path, 100_000)
    single = field_bench(tmp_path, picture, "field_psf", params, step_mrad=STEP,
                         precision="single")  # fmt: skip
    assert np.abs(single.value("it.image") - bench.value("it.image")).max() < 1e-6
    flat = field_bench(tmp_path, np.full((90, 111), 7.0), "field_psf", params, step_mrad=STEP)
    np.testing.assert_allclose(flat.value("it.image"), 7.0, rtol=1e-13)
    bench, width = cube_bench(tmp_path, "field_psf", params, fov_x_deg=0.2, fov_y_deg=0.15)
    bands = bench.port("it.image").bands
    whole = sum(width * bench.work.value(bands.band(n)) for n in range(3))
    np.testing.assert_allclose(whole, bench.value("it.image"), rtol=1e-12)


@pytest.mark.parametrize(
    ("params", "words"),
    [({"positions": [0.5, 0.5]}, "positions = .* in ascending order"),
     ({"tangential_mrad": [1.0]}, "tangential_mrad = .*3 numbers"),
     ({"kind": "mtf"}, "path_1 .*a file for each position .3 positions"),
     ({"kind": "psf", "path_1": "1.npy"}, "path_2 .*a file for each position .3 positions")],
)  # fmt: skip
def test_what_is_refused(tmp_path, params, words):
    np.save(tmp_path / "1.npy", np.ones((3, 3)))
    camera = {"pitch_um": 10, "focal_length_mm": 100}
    if params.get("kind") == "psf":
        params = {**params, "sample_pitch_um": 1.0}
    with pytest.raises(ParameterError, match=words):
        field_bench(tmp_path, np.ones((9, 9)), "field_psf", params, camera=camera)
