"""Few wavelengths for all: the error is what is stated, and uniform pictures stay as they are."""

import numpy as np
import pytest
from scipy.linalg import qr

from core.chain.back_transformed import combine_pixels
from core.chain.band_stack import AttenuatedBands, few_wavelengths
from core.evaluation.work import Policy
from cube_files import centres, disc_otf, materials_cube, write_cube
from node_bench import NodeBench

WAVELENGTHS, _ = centres(60)


ALL = tuple(range(len(WAVELENGTHS)))


def table(nyquist, places=1200):
    return disc_otf(np.linspace(0, nyquist, places)[:, np.newaxis], WAVELENGTHS, 100.0)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-9])
def test_the_bound_holds_at_frequencies_that_were_not_looked_at(tolerance):
    rank = few_wavelengths(table(18.0)[::2], table(18.0)[1::2], tolerance=tolerance)
    between = disc_otf(np.linspace(0.001, 17.99, 977)[:, np.newaxis], WAVELENGTHS, 100.0)
    error = np.abs(between - between[:, rank.chosen] @ rank.shares).max()
    assert error <= 1.05 * rank.bound
    assert rank.bound <= tolerance
    assert 1 < len(rank.chosen) < 60


def test_shares_of_every_band_sum_up_to_one():
    rank = few_wavelengths(table(12.0)[::2], table(12.0)[1::2], tolerance=1e-5)
    assert np.abs(rank.shares.sum(axis=0) - 1.0).max() < 1e-13
    assert np.array_equal(rank.shares[:, rank.chosen], np.eye(len(rank.chosen)))


def test_functions_that_no_few_span_are_all_taken():
    drawn = np.random.default_rng(3).standard_normal((500, 12))
    rank = few_wavelengths(drawn[::2], drawn[1::2], tolerance=1e-6)
    assert rank.chosen == tuple(range(12))
    assert rank.bound == 0.0


def test_complex_functions_are_fitted_in_both_parts():
    frequency = np.linspace(0, 3, 400)[:, np.newaxis]
    turned = np.exp(1j * frequency * np.linspace(0.5, 0.7, 30))
    rank = few_wavelengths(turned[::2], turned[1::2], tolerance=1e-6)
    assert np.abs(turned - turned[:, rank.chosen] @ rank.shares).max() <= 1e-6
    assert len(rank.chosen) < 12


def test_as_many_steps_as_wavelengths_and_those_of_lapack(monkeypatch):
    """A step over a thousand bands takes as long as all else that is done to choose a few."""
    norms, norm = [], np.linalg.norm
    monkeypatch.setattr(np.linalg, "norm", lambda *a, **k: norms.append(a) or norm(*a, **k))
    fitted, judged = table(12.0)[::2], table(12.0)[1::2]
    rank = few_wavelengths(fitted, judged, tolerance=1e-4)
    assert len(norms) - 1 == len(rank.chosen) < len(WAVELENGTHS) / 2
    *_, order = qr(fitted, mode="economic", pivoting=True)
    assert rank.chosen == tuple(sorted(order[: len(rank.chosen)]))


def test_where_more_than_so_many_are_needed_all_are_taken():
    fitted, judged = table(12.0)[::2], table(12.0)[1::2]
    needed = len(few_wavelengths(fitted, judged, tolerance=1e-4).chosen)
    assert few_wavelengths(fitted, judged, tolerance=1e-4, most=needed).chosen != ALL
    assert few_wavelengths(fitted, judged, tolerance=1e-4, most=needed - 1).chosen == ALL


# The spectrum of a sample: read alone, attenuated, averaged over blocks, none after filters.

BANDS = 12
SIZE = (19, 22)
FOV = {"fov_x_deg": 1.0, "fov_y_deg": 0.9}


@pytest.fixture(params=["bsq", "bil", "bip"])
def scene(request, tmp_path):
    wavelengths, width = centres(BANDS)
    cube = materials_cube(SIZE, wavelengths)
    write_cube(tmp_path, cube, wavelengths, width, order=request.param)
    nodes = {
        "read": ("read_image", {"path": "cube.img", "bands": "all", **FOV}),
        "init": ("init_trans", {"focal_length_mm": 100.0}),
        "jitter": ("jitter_mtf", {"sigma_mrad": 0.1}),
        "back": ("back_transform", {}),
    }
    return cube, NodeBench(tmp_path, nodes)


def made(bench, recipe):
    return bench.engine.work(Policy("double")).value(recipe)


def test_of_one_sample(scene):
    cube, bench = scene
    bands = bench.port("read.image").bands
    for row, column in ((0, 0), (18, 21), (7, 3)):
        spectrum = made(bench, bands.spectrum(row, column))
        assert spectrum == pytest.approx(cube[:, row, column], rel=1e-14)


def test_attenuated(scene):
    cube, bench = scene
    gain = tuple(np.linspace(0.9, 0.2, BANDS).tolist())
    offset = tuple(np.linspace(0.0, 3.0, BANDS).tolist())
    bands = AttenuatedBands.of(bench.port("read.image").bands, gain=gain, offset=offset)
    expected = cube[:, 4, 9] * np.array(gain) + np.array(offset)
    assert made(bench, bands.spectrum(4, 9)) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize(("mode", "times"), [("mean", 1), ("sum", 15)])
def test_of_blocks_of_blocks(scene, mode, times):
    """Blocks of 5 × 3 samples, and of these 2 × 2: what is left over is cropped."""
    cube, bench = scene
    image = combine_pixels(bench.port("read.image"), factor_x=5, factor_y=3, mode=mode)
    blocks = cube[:, 3:6, 10:15].mean(axis=(1, 2))
    assert made(bench, image.bands.spectrum(1, 2)) == pytest.approx(times * blocks, rel=1e-13)
    again = combine_pixels(image, factor_x=2, factor_y=2)
    blocks = cube[:, 6:12, 10:20].mean(axis=(1, 2))
    assert made(bench, again.bands.spectrum(1, 1)) == pytest.approx(times * blocks, rel=1e-13)


def test_behind_a_filter_there_is_none(scene):
    _, bench = scene
    assert bench.port("back.image").bands.spectrum(3, 3) is None
    attenuated = AttenuatedBands.of(bench.port("back.image").bands, gain=(0.5,) * BANDS)
    assert attenuated.spectrum(3, 3) is None
