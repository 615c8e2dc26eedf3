"""A cube of 1 GB, and one of 4, go from their file to electrons in the memory of a few pictures."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from child_process import PEAK, ROOT, finished
from linked_network import document_of

BANDS, LIT = 1000, 16
# Sides of a picture, and the memory a run may take: the libraries take some 100 MB of it.
MOST_KB = {512: 500_000, 1024: 1_000_000}
LOW_UM, HIGH_UM = 3.0, 5.0
WIDTH_UM = (HIGH_UM - LOW_UM) / BANDS
CENTRES_UM = LOW_UM + (np.arange(BANDS) + 0.5) * WIDTH_UM
PHOTON_J_UM = 6.62607015e-34 * 299792458.0 * 1e6
RUN = f"""
from pathlib import Path
from core.chain.engine import Engine
from core.evaluation.work import Policy
from core.network.file import load_network
from nodes.library import standard_library
library = standard_library()
engine = Engine(library)
plan = engine.plan(load_network(Path("net.json"), library=library), folder=Path())
assert plan.errors() == [], plan.errors()
picture = engine.value(plan, "focal_plane.image", engine.work(Policy()))
print(picture.shape, float(picture.mean(dtype=float)))
{PEAK}
"""


@pytest.fixture
def cube(tmp_path, side):
    """Zeros that take no room on the disk, but for the first rows."""
    data = tmp_path / "cube.img"
    line = (1.0 + CENTRES_UM)[:, np.newaxis] * (1.0 + 0.1 * np.sin(np.arange(side) / 20.0))
    with data.open("wb") as file:
        for _ in range(LIT):
            file.write(line.astype("<f4").tobytes())
        file.truncate(side * side * BANDS * 4)
    if getattr(data.stat(), "st_blocks", 1 << 30) * 512 > 1 << 29:
        data.unlink()
        pytest.skip("this disk stores zeros: the file would take gigabytes of it")
    data.with_name("cube.img.hdr").write_text(
        f"ENVI\nsamples = {side}\nlines = {side}\nbands = {BANDS}\nheader offset = 0\n"
        "data type = 4\ninterleave = bil\nbyte order = 0\ndata units = W/m^2/sr/um\n"
        f"wavelength = {{{', '.join(map(repr, CENTRES_UM.tolist()))}}}\n"
        f"fwhm = {{{', '.join([repr(WIDTH_UM)] * BANDS)}}}\n"
    )
    yield line.mean(axis=1) * LIT / side
    data.unlink()


@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="peak memory is read in /proc")
@pytest.mark.parametrize("side", [512, pytest.param(1024, marks=pytest.mark.thorough)])
def test_the_memory_of_a_few_pictures(side, cube, tmp_path):
    fov = {"fov_x_deg": 2.0, "fov_y_deg": 2.0}
    lens = {"focal_length_mm": 100.0, "f_number": 4.0}
    nodes = {
        "read": (
            "read_image",
            {"path": "cube.img", "bands": "all", **fov},
        ),
        "init": ("init_trans", {**lens, "detector_x_um": 15.0, "detector_y_um": 15.0}),
        "optics": ("diffraction_mtf", {"aperture_mm": 300.0}),
        "back": ("back_transform", {}),
        "focal_plane": ("focal_plane", {"units": "electrons"}),
    }
    (tmp_path / "net.json").write_text(json.dumps(document_of(nodes, seed=1)))
    code = f"import sys; sys.path.insert(0, {str(ROOT)!r})\n{RUN}"
    done = finished([sys.executable, "-c", code], folder=tmp_path)
    assert done.returncode == 0, done.stderr
    shape_and_mean, peak = done.stdout.splitlines()
    assert shape_and_mean.startswith(f"({side}, {side})")
    # t·A·Ω·QE·Σ L·λ/hc; no transfer function changes the mean, and a million shots hardly do.
    photons = np.sum(cube * WIDTH_UM * CENTRES_UM / PHOTON_J_UM)
    electrons = 1e-3 * (15e-6) ** 2 * np.pi / (4 * 4.0**2 + 1) * 0.7 * photons
    assert float(shape_and_mean.split()[-1]) == pytest.approx(electrons, rel=1e-3)
    assert int(peak) < MOST_KB[side]
