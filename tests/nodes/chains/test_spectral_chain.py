"""A cube goes through optics band by band: the same as filtering every band by itself."""

import numpy as np
import pytest

from core.chain.random_fields import at_frame
from core.evaluation.work import Policy
from cube_files import band_by_band, centres, materials_cube, write_cube
from node_bench import NodeBench, fov_of

INTERVAL = 0.035
BANDS = 60
SIZE = (64, 80)


def network(*, read=(), optics=(), **more):
    read = {"path": "cube.img", "bands": "all", **fov_of(SIZE, INTERVAL), **dict(read)}
    return {
        "read": ("read_image", read),
        "init": ("init_trans", {"focal_length_mm": 100.0, "f_number": 1.0}),
        "optics": ("diffraction_mtf", {"aperture_mm": 100.0, **dict(optics)}),
        "back": ("back_transform", {}),
        **more,
    }


@pytest.fixture
def cube(tmp_path):
    wavelengths, width = centres(BANDS)
    samples = materials_cube(SIZE, wavelengths)
    write_cube(tmp_path, samples, wavelengths, width)
    return samples, wavelengths, width


def expected(cube, weights=None):
    samples, wavelengths, width = cube
    weights = np.full(len(wavelengths), width) if weights is None else weights
    return band_by_band(samples, wavelengths, weights, interval_mrad=INTERVAL, aperture_mm=100.0)


def delivered(folder, *, policy, nodes=None, port="back.image"):
    bench = NodeBench(folder, nodes or network())
    work = bench.engine.work(policy)
    return bench.engine.value(bench.plan, port, work), bench, work


@pytest.mark.parametrize("order", ["bsq", "bil", "bip"])
def test_with_tolerance_0_it_is_the_sum_band_by_band(tmp_path, cube, order):
    write_cube(tmp_path, *cube, order=order)
    made, *_ = delivered(tmp_path, policy=Policy("double", 0.0))
    want = expected(cube)
    assert np.abs(made - want).max() <= 1e-12 * np.ptp(want)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-5])
def test_a_low_rank_is_within_the_bound_that_is_stated(tmp_path, cube, tolerance):
    made, bench, work = delivered(tmp_path, policy=Policy("double", tolerance))
    want = expected(cube)
    rank = bench.port("back.image").recipe.rank(work)
    samples = cube[0]
    # Band by band, each by the rms of its own contrast.
    allowed = rank.bound * cube[2] * samples.std(axis=(1, 2)).sum()
    assert 0.0 < rank.bound <= tolerance
    assert len(rank.chosen) < BANDS
    assert np.sqrt(np.mean((made - want) ** 2)) <= allowed
    assert np.abs(made - want).max() <= tolerance * np.ptp(want)


def test_pixels_combined_behind_it_are_the_means_of_that_picture(tmp_path, cube):
    nodes = network(pixels=("combine_pixels", {"factor_x": 4, "factor_y": 2}))
    made, *_ = delivered(tmp_path, policy=Policy("double", 0.0), nodes=nodes, port="pixels.image")
    want = expected(cube).reshape(32, 2, 20, 4).mean(axis=(1, 3))
    assert np.abs(made - want).max() <= 1e-12 * np.ptp(want)


def test_an_interval_within_the_cube_counts_bands_by_their_part(tmp_path, cube):
    read = {"cut_on_um": 3.5, "cut_off_um": 4.25}
    made, *_ = delivered(tmp_path, policy=Policy("double", 0.0), nodes=network(read=read))
    samples, wavelengths, width = cube
    low = np.maximum(wavelengths - width / 2, 3.5)
    high = np.minimum(wavelengths + width / 2, 4.25)
    part = np.clip(high - low, 0.0, None)
    # What is left of a band at an end lies about a wavelength of its own.
    want = expected((samples, (low + high) / 2, width), part)
    assert np.abs(made - want).max() <= 1e-12 * np.ptp(want)


def test_bands_that_do_not_count_choose_no_wavelengths(tmp_path, cube):
    nodes = network(filter=("spectral_response", {"centre_um": 4.0, "width_um": 0.3}))
    policy = Policy("double", 1e-6)
    made, bench, work = delivered(tmp_path, policy=policy, nodes=nodes, port="filter.image")
    recipe = bench.port("filter.image").recipe
    rank = next(work.value(one).shares for one in (recipe.inputs[0].filtered_sum.wavelengths,))
    _, wavelengths, width = cube
    low, high = wavelengths - width / 2, wavelengths + width / 2
    part = np.clip(np.minimum(high, 4.15) - np.maximum(low, 3.85), 0.0, None)
    assert rank.shape[1] == np.count_nonzero(part > 1e-12)
    want = expected(cube, part)
    assert np.abs(made - want).max() <= 1e-6 * np.ptp(want)


def test_later_frames_of_a_moving_picture_go_through_a_second_chain(tmp_path, cube):
    nodes = network()
    del nodes["back"]
    nodes["sight"] = ("line_of_sight", {"rms_x_mrad": 0.3, "frame_rate_Hz": 50.0})
    nodes["back"] = ("back_transform", {})
    nodes["pixels"] = ("combine_pixels", {"factor_x": 3, "factor_y": 2})  # not a whole number
    nodes["again"] = ("init_trans", {"focal_length_mm": 100.0, "f_number": 1.0})
    nodes["end"] = ("back_transform", {})
    bench = NodeBench(tmp_path, nodes)
    work = bench.engine.work(Policy("double", 0.0))
    first, last = bench.port("pixels.image"), bench.port("end.image")
    assert last.bands.count == BANDS
    frames = [work.value(at_frame(last.recipe, number)) for number in range(3)]
    for number, frame in enumerate(frames):
        want = work.value(at_frame(first.recipe, number))
        assert np.abs(frame - want).max() <= 1e-12 * np.ptp(want)
    assert np.abs(frames[1] - frames[0]).max() > 1e-3 * np.ptp(frames[0])


@pytest.mark.parametrize("optics", [{}, {"defocus_waves": 0.1}])
def test_many_wavelengths_are_summed_in_several_passes(tmp_path, cube, monkeypatch, optics):
    nodes = network(optics=optics)
    whole, *_ = delivered(tmp_path, policy=Policy("double", 0.0), nodes=nodes)
    samples = SIZE[0] * SIZE[1]
    monkeypatch.setattr("core.chain.band_stack.SAMPLES_AT_ONCE", 7 * samples)
    bench = NodeBench(tmp_path, nodes)
    work, sizes = bench.engine.work(Policy("double", 0.0)), []
    compute = type(work)._compute
    monkeypatch.setattr(
        type(work), "_compute", lambda *a: [sizes.append(work.store.used_bytes), compute(*a)][1]
    )
    made = bench.engine.value(bench.plan, "back.image", work)
    np.testing.assert_allclose(made, whole, rtol=1e-12)
    # All 60 wavelengths, and no more than some passes of 7 are there at a time.
    assert max(sizes) < 60 * samples * 8 / 2


@pytest.mark.parametrize("index", [0, 23, 59])
def test_a_band_alone_is_filtered_once_at_its_own_wavelength(tmp_path, cube, index):
    bench = NodeBench(tmp_path, network())
    work = bench.engine.work(Policy("double", 1e-2))
    band = bench.port("back.image").bands.band(index)
    assert len(band.rank(work).chosen) == 1
    weights = np.zeros(BANDS)
    weights[index] = 1.0
    want = expected(cube, weights)
    # A tolerance of 1 % would let few wavelengths err by that; its own does not.
    assert np.abs(work.value(band) - want).max() <= 1e-12 * np.ptp(want)
