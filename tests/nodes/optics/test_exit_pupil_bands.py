"""Exit Pupil MTF on a cube: every band at its own wavelength; weights of a band by its light."""

from __future__ import annotations

import numpy as np
import pytest

from core.evaluation.work import Policy
from cube_files import C2_UM, centres, disc_otf, materials_cube, write_cube
from node_bench import NodeBench
from nodes.library import standard_library

LIBRARY = standard_library()

SIZE = (32, 40)
INTERVAL = 0.035
BANDS = 6
PUPIL = {"size_x": 128, "size_y": 128, "radius": 50}


@pytest.fixture
def cube(tmp_path):
    wavelengths, width = centres(BANDS)
    samples = materials_cube(SIZE, wavelengths)
    write_cube(tmp_path, samples, wavelengths, width)
    return samples, wavelengths, width


def bench(folder, *, read, pupil=(), otf=()):
    fov = {
        "fov_x_deg": float(np.degrees(INTERVAL * 1e-3 * SIZE[1])),
        "fov_y_deg": float(np.degrees(INTERVAL * 1e-3 * SIZE[0])),
    }
    nodes = {
        "read": ("read_image", {**fov, **read}),
        "init": ("init_trans", {"focal_length_mm": 100.0, "f_number": 1.0}),
        "pupil": ("exit_pupil", {**PUPIL, **dict(pupil)}),
        "otf": ("exit_pupil_mtf", {"size_x_cm": 12.8, "size_y_cm": 12.8, **dict(otf)}),
        "back": ("back_transform", {}),
    }
    return NodeBench(LIBRARY, folder, nodes)


def delivered(there):
    work = there.engine.work(Policy("double", 0.0))
    return there.engine.value(there.plan, "back.image", work)


ALL = {"path": "cube.img", "bands": "all"}


@pytest.mark.parametrize(
    "pupil", [{"defocus_waves": 0.4}, {"zernike_waves": (0, 0, 0, 0, 0, 0, 0.12, 0.05)}]
)
def test_a_wavefront_error_counts_by_the_waves_of_every_band(tmp_path, cube, pupil):
    """The same as the sum of pictures of one band, whose waves are those of the whole band."""
    made = delivered(bench(tmp_path, read=ALL, pupil=pupil))
    samples, wavelengths, width = cube
    middle = 4.0
    want = 0.0
    for band, wavelength in zip(samples, wavelengths, strict=True):
        np.save(tmp_path / "one.npy", band)
        scaled = {
            name: value * middle / wavelength
            if np.isscalar(value)
            else tuple(one * middle / wavelength for one in value)
            for name, value in pupil.items()
        }
        at = {"cut_on_um": float(wavelength), "cut_off_um": float(wavelength)}
        one = bench(tmp_path, read={"path": "one.npy"}, pupil=scaled, otf=at)
        want = want + width * delivered(one)
    assert np.abs(made - want).max() <= 1e-11 * np.ptp(want)


@pytest.mark.parametrize(("weighting", "power"), [("photons", 4), ("energy", 5)])
def test_wavelengths_of_one_band_count_by_the_light_of_a_body(tmp_path, weighting, power):
    np.save(tmp_path / "flat.npy", np.ones(SIZE))
    there = bench(
        tmp_path,
        read={"path": "flat.npy", "cut_on_um": 3.0, "cut_off_um": 5.0},
        otf={"wavelengths": 24, "weighting": weighting, "source_K": 300.0},
    )
    mtf = there.value("otf.mtf")
    um = 3.0 + 2.0 * (np.arange(20000) + 0.5) / 20000
    light = um**-power / np.expm1(C2_UM / um / 300.0)
    row = np.asarray(mtf)[0] if np.asarray(mtf)[0, 0] == 1.0 else None
    frequency = there.port("otf.mtf").grid.xi()
    at = 5
    want = np.sum(light * disc_otf(frequency[at], um, 100.0)) / light.sum()
    measured = row[at] if row is not None else np.asarray(mtf)[SIZE[0] // 2, SIZE[1] // 2 + at]
    assert measured == pytest.approx(want, abs=1e-6)
