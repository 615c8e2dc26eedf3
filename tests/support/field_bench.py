"""Pictures that are functions of the angle, in networks of one module over the field."""

import numpy as np

from core.chain.engine import Engine
from core.evaluation.work import BlockRun, Work
from core.machine import ScratchDisk, is_on_disk
from cube_files import centres, write_cube
from node_bench import NodeBench, fov_of
from nodes.library import standard_library

LIBRARY = standard_library()


def field_bench(folder, picture, key, params, *, step_mrad=1.0, camera=None, precision="double"):
    """The module as `it` behind a picture of samples `step_mrad` apart."""
    np.save(folder / "picture.npy", picture)
    fov = fov_of(picture.shape, step_mrad)
    nodes = {"read": ("read_image", {"path": "picture.npy", **fov})}
    if camera is not None:
        nodes["camera"] = ("camera", camera)
    bench = NodeBench(folder, {**nodes, "it": (key, params)}, precision=precision)
    error = bench.error("it")
    if error is not None:
        raise error
    return bench


def cube_bench(folder, key, params, *, fov_x_deg=40, fov_y_deg=30):
    """The module as `it` behind a cube of three bands; with the bands' width."""
    waves, width = centres(3, low=3.0, high=5.0)
    cube = np.random.default_rng(1).random((3, 30, 43)) + 1.0
    write_cube(folder, cube, waves, width, kind="f8", unit="W/m^2/sr/um")
    read = {"path": "cube.img", "bands": "all", "fov_x_deg": fov_x_deg, "fov_y_deg": fov_y_deg}
    nodes = {"read": ("read_image", read), "it": (key, params)}
    return NodeBench(folder, nodes), width


def angles(shape, step_mrad):
    """Tangents of the angles from the axis of all samples, across and along."""
    y, x = (1e-3 * step_mrad * (np.arange(n) - (n - 1) / 2) for n in shape)
    return np.meshgrid(x, y)


def assert_same_in_blocks(bench, port, folder, memory_bytes):
    """With pictures on disk, the same to the bit; no slab of any is larger than its share."""
    recipe = bench.port(port).recipe
    shapes = {one.key: bench.port(port).shape for one in (recipe, *recipe.inputs)}
    assert recipe.in_blocks
    with ScratchDisk(folder, memory_bytes) as disk:
        blocks = BlockRun(disk, shapes)
        work = Work(bench.work.policy, Engine(LIBRARY).store, blocks=blocks)
        made = work.value(recipe)
        assert is_on_disk(made)
        np.testing.assert_array_equal(made, bench.value(port))
