"""Arrays on disk: where they lie, how long, and what is left of them."""

import gc
from itertools import product

import numpy as np
import pytest

from core.chain.back_transformed import back_transform, combine_pixels
from core.chain.random_fields import local_mean
from core.chain.wires import Image, Magnitude, Phase
from core.errors import FileError
from core.evaluation.recipes import Step, Store, in_blocks, size_in_bytes
from core.evaluation.work import BlockRun, Policy, Work
from core.machine import ScratchDisk, is_on_disk
from core.transfer.factors import Law, Planar, Separable


@pytest.fixture
def disk(tmp_path):
    with ScratchDisk(tmp_path, 1 << 20) as made:
        yield made


def test_what_lies_there(disk, tmp_path):
    assert disk.wants((129, 128), np.float32)  # of 1 MiB, more than a sixteenth
    assert not disk.wants((128, 128), np.float32)
    array = disk.empty((300, 200), np.float64)
    array[:] = np.arange(60000.0).reshape(300, 200)
    disk.trim()
    assert array.sum() == 59999 * 30000  # as it was written, though let go of
    assert is_on_disk(array[7:9])
    assert is_on_disk((1, array))
    assert is_on_disk((array, 0.0))
    assert not is_on_disk(array.copy())
    assert not list(tmp_path.iterdir())  # without a name, nothing can be left


def test_a_store_keeps_it_only_while_it_is_pinned(disk):
    store = Store(1 << 30)
    store.pin("a")
    for key in "ab":
        store.get(key, lambda: disk.empty((300, 200), np.float64))
    assert (store.holds("a"), store.holds("b")) == (True, False)
    assert store.used_bytes == size_in_bytes(disk.empty((2, 2), np.int8))  # of memory
    store.unpin("a")
    assert not store.holds("a")
    gc.collect()
    assert (disk.files, disk.most_bytes) == (3, 960_000)  # never three at a time


def test_no_folder_one_line(tmp_path):
    with pytest.raises(FileError, match=r"cannot write to the scratch folder .*away: No such file"):
        ScratchDisk(tmp_path / "away", 1000).empty((3,), np.float64)


# Filtered pictures that are made on disk are those made in memory, to the bit.

SHAPES = ((32, 24), (31, 37), (1, 48), (48, 1), (30, 45))
MEMORY = 4000  # bytes: strips of a column or two, slabs of a row


@in_blocks()
def scene(work, *, shape):
    return np.random.default_rng(5).normal(10.0, 2.0, shape).astype(work.policy.dtype)


def gaussian(frequency):
    return np.exp(-2.0 * (0.6 * np.pi * frequency) ** 2)


def lag(frequency):
    return -0.7 * frequency


def tilted(xi, eta):
    return np.exp(-((xi + 0.5 * eta) ** 2) + 0.4j * xi)


def conical(rho):
    return np.exp(-0.3 * rho)


LAGS = (Separable(Law.of(lag), Law.of(lag), part="ptf"),)
FACTORS = {
    "separable": ((Separable(Law.of(gaussian), Law.of(gaussian)),), ()),
    "phases": ((Separable(Law.of(gaussian), None),), LAGS),
    "radial": ((Planar(Law.of(conical), radial=True, symmetric=True),), LAGS),
    "tilted": ((Planar(Law.of(tilted), take="modulus"),), (Planar(Law.of(tilted), take="phase"),)),
}


def image_of(shape):
    recipe = Step.of(scene, node="scene", shape=shape)
    return Image(recipe, *shape, interval_x_mrad=1.0, interval_y_mrad=1.25)


@pytest.fixture(scope="module")
def disk_of_transforms_on_disk(tmp_path_factory):
    with ScratchDisk(tmp_path_factory.mktemp("scratch"), MEMORY) as made:
        yield made


def on_disk(image, disk_of_transforms_on_disk, policy):
    """The picture's samples, made in blocks."""
    return Work(
        policy, Store(1000), blocks=BlockRun(disk_of_transforms_on_disk, {image.key: image.shape})
    ).value(image.recipe)


@pytest.mark.thorough(but=9)
@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("factors", FACTORS)
def test_filtered(disk_of_transforms_on_disk, factors, edges, precision):
    policy = Policy(precision, 0.0, threads=2)
    for shape, factor in product(SHAPES, (1, 2, 3)):
        source = image_of(shape)
        grid, (mtfs, ptfs) = source.grid(), FACTORS[factors]
        spectrum = Magnitude(source, grid, edges, mtfs), Phase(source, grid, edges, ptfs)
        image = back_transform(*spectrum)
        if factor <= min(shape):
            image = combine_pixels(image, factor_x=factor, factor_y=factor)
        expected = Work(policy, Store()).value(image.recipe)
        made = on_disk(image, disk_of_transforms_on_disk, policy)
        np.testing.assert_array_equal(made, expected)
        assert is_on_disk(made) == disk_of_transforms_on_disk.wants(made.shape, made.dtype)


@pytest.mark.parametrize("sigma_px", [0.0, 0.7, 5.0])
def test_local_mean(disk_of_transforms_on_disk, sigma_px):
    for shape in SHAPES:
        policy = Policy("single")
        image = scene(Work(policy, Store()), shape=shape)
        expected = local_mean(Work(policy, Store()), image, sigma_px=sigma_px)
        work = Work(policy, Store(), blocks=BlockRun(disk_of_transforms_on_disk, {}))
        np.testing.assert_array_equal(local_mean(work, image, sigma_px=sigma_px), expected)


def test_direct_sum(disk_of_transforms_on_disk):
    """Mirrored cosine by cosine: another way than transforms in either place."""
    shape = (12, 10)
    source = image_of(shape)
    factors = FACTORS["separable"][0]
    spectrum = Magnitude(source, source.grid(), "reflect", factors), Phase(source, source.grid())
    policy = Policy("double", 0.0)
    with ScratchDisk(disk_of_transforms_on_disk.folder, 1000) as small:
        made = on_disk(back_transform(*spectrum), small, policy)
    rows, columns = shape
    basis = [
        np.cos(np.pi * np.outer(np.arange(n) + 0.5, np.arange(n)) / n)
        * np.sqrt(np.where(np.arange(n) == 0, 1.0, 2.0) / n)
        for n in shape
    ]
    along = gaussian(np.arange(rows) / (2 * rows * 1.25))
    across = gaussian(np.arange(columns) / (2 * columns * 1.0))
    image = scene(Work(policy, Store()), shape=shape)
    waves = basis[0].T @ image @ basis[1] * np.outer(along, across)
    np.testing.assert_allclose(made, basis[0] @ waves @ basis[1].T, rtol=0, atol=1e-12 * 20)
