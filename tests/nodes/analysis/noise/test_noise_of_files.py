"""3-D Noise of files of frames: drawn by numpy with components that are known, and of a chain."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image as Pillow

from core.physics.noise.noise_components import COMPONENTS
from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()
SIGMAS = {"tvh": 9.0, "vh": 6.0, "v": 3.0, "h": 4.0, "t": 2.0, "tv": 2.5, "th": 1.5}
FRAMES, ROWS, COLUMNS = 150, 80, 120


def drawn(seed=4):
    """Frames that are sums of seven independent fields about a level of 5000."""
    random = np.random.default_rng(seed)
    sizes = {"t": FRAMES, "v": ROWS, "h": COLUMNS}
    cube = np.full((FRAMES, ROWS, COLUMNS), 5000.0)
    for name, sigma in SIGMAS.items():
        shape = [sizes[axis] if axis in name else 1 for axis in "tvh"]
        cube += sigma * random.standard_normal(shape)
    return cube


def write(folder, name, cube):
    path = folder / name
    if name.endswith(".npy"):
        np.save(path, cube.astype(np.float32))
    elif name.endswith(".tif"):
        first, *others = (Pillow.fromarray(one) for one in cube.astype(np.float32))
        first.save(path, save_all=True, append_images=others)
    else:
        cube.astype("<f4").tofile(path)
        frames, rows, columns = cube.shape
        path.with_name(f"{name}.hdr").write_text(
            f"ENVI\nsamples = {columns}\nlines = {rows}\nbands = {frames}\ndata type = 4\n"
            "interleave = bsq\nbyte order = 0\ndata units = DN\n"
        )


def planned(folder, params, *, image=None):
    nodes = {} if image is None else {"scene": ("read_image", image)}
    return NodeBench(LIBRARY, folder, {**nodes, "noise": ("noise_3d", params)}, precision="single")


def table(folder, params, **how):
    bench = planned(folder, params, **how)
    assert bench.plan.errors() == []
    return bench.value("noise.table")


@pytest.mark.parametrize("name", ["f.npy", "f.tif", "f.bsq"])
def test_components_of_a_file(tmp_path, name):
    """Within four standard errors: σ²·√(2/degrees of freedom) of each component's own average."""
    write(tmp_path, name, drawn())
    made = table(tmp_path, {"path": name})
    figures = made.as_dict()
    free = {"t": FRAMES - 1, "v": ROWS - 1, "h": COLUMNS - 1}
    sizes = {"t": FRAMES, "v": ROWS, "h": COLUMNS}
    for component, sigma in SIGMAS.items():
        # A mean square is of the components that contain its axes, each over what it averages.
        square = sum(
            other**2 * np.prod([sizes[axis] for axis in sizes if axis not in within], initial=1.0)
            for within, other in SIGMAS.items()
            if set(component) <= set(within)
        ) / np.prod([sizes[axis] for axis in sizes if axis not in component], initial=1.0)
        error = square * np.sqrt(2.0 / np.prod([free[axis] for axis in component]))
        measured = figures[f"sigma_{component}_measured"]
        assert abs(measured**2 - sigma**2) < 4 * 1.5 * error, component
    assert figures["mean"] == pytest.approx(5000.0, abs=4 * np.hypot(2 / 12, 0.6))
    assert figures["frames"] == FRAMES
    assert {row.unit for row in made.rows} == {"DN" if name == "f.bsq" else "", ""}
    assert f"sigma_{COMPONENTS[0]}" not in figures


def test_what_is_refused(tmp_path):
    cube = drawn()[:3]
    for name in ("f.npy", "f.bsq"):
        write(tmp_path, name, cube)
    np.save(tmp_path / "one.npy", cube[0])
    np.save(tmp_path / "small.npy", cube[0, :7])

    def line(params, **how):
        (error,) = planned(tmp_path, params, **how).plan.errors()
        return str(error).replace(f"{tmp_path}/", "")

    assert line({}) == (
        "noise: path is empty: give a file of frames, or link an image"
    )  # fmt: skip
    assert line({"path": "none.npy"}) == "noise: none.npy: no such file"
    assert line({"path": "one.npy"}) == (
        "noise: one.npy has only one frame; temporal noise needs 2 or more"
    )
    assert line({"path": "f.npy"}, image={"path": "small.npy"}) == (
        "noise: f.npy: frames of 80 × 120 samples, but the linked picture "
        "has 7 × 120: link a picture from the same camera, or no picture"
    )
    assert line({"path": "f.bsq"}, image={"path": "one.npy", "unit": "K"}) == (
        "noise: f.bsq: frames in 'DN', but the linked picture is in 'K': "
        "link a picture in the same unit, or no picture"
    )
