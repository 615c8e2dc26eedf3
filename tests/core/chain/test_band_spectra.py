"""The spectrum of a sample: read alone, attenuated, averaged over blocks, none after filters."""

import numpy as np
import pytest

from core.chain.back_transformed import combine_pixels
from core.chain.band_stack import AttenuatedBands
from core.evaluation.work import Policy
from cube_files import centres, materials_cube, write_cube
from node_bench import NodeBench
from nodes.library import standard_library

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
    links = [
        ("read.image", "init.image"),
        ("init.context", "jitter.context"),
        ("init.magnitude", "jitter.magnitude"),
        ("jitter.magnitude", "back.magnitude"),
        ("init.phase", "back.phase"),
    ]
    return cube, NodeBench(standard_library(), tmp_path, nodes, links)


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
