"""Wavefronts on pupils from files, against the integral over a defocused disc."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from core.physics.optics.pupil_shapes import PupilShape, sample_pupil
from node_bench import NodeBench
from nodes.library import standard_library

SIZE, RADIUS = 128, 40.0
WAVELENGTH, SIZE_CM = 10.0, 2.56
SCENE = {"kind": "uniform", "width": 32, "height": 32, "fov_x_deg": 3.0, "fov_y_deg": 3.0}


def defocused_disc(lag, w20):
    """Overlap of two unit discs `lag` apart, of phases 2π·W20·ρ²: one integral across them."""
    if lag >= 2:
        return 0.0
    end = 1 - lag / 2
    return 2 / np.pi * quad(
        lambda x: np.sqrt(max(1 - (abs(x) + lag / 2) ** 2, 0)) * np.cos(4 * np.pi * w20 * lag * x),
        -end, end, points=[0.0], epsabs=1e-10, limit=400,
    )[0]  # fmt: skip


def mtf(folder, pupil, wavelength=WAVELENGTH):
    """MTF, and the frequencies across that are below the cutoff."""
    nodes = {
        "scene": ("test_scene", SCENE),
        "init": ("init_trans", {}),
        "pupil": ("exit_pupil", pupil),
        "optics": (
            "exit_pupil_mtf",
            {
                "cut_on_um": wavelength,
                "cut_off_um": wavelength,
                "size_x_cm": SIZE_CM,
                "size_y_cm": SIZE_CM,
            },
        ),
    }
    bench = NodeBench(standard_library(), folder, nodes)
    assert bench.plan.errors() == []
    return bench.value("optics.mtf")


def saved(folder, shape="clear", shift=(0, 0), size=SIZE):
    samples = sample_pupil(PupilShape(shape, radius=RADIUS), rows=SIZE, columns=SIZE)
    array = np.zeros((size, size))
    array[:SIZE, :SIZE] = samples
    np.save(folder / "pupil.npy", np.roll(array, shift, axis=(0, 1)))
    return {"shape": "file", "path": "pupil.npy"}


def truth(w20):
    """At the image's frequencies across: lags λ·xi over the aperture's radius."""
    interval = np.radians(3.0) * 1000 / 32
    xi = np.arange(16) / (32 * interval)
    radius_mm = RADIUS / SIZE * SIZE_CM * 10
    return np.array([defocused_disc(WAVELENGTH * f / radius_mm, w20) for f in xi])


@pytest.mark.parametrize("w20", [0.5, -1.0, 2.0])
@pytest.mark.parametrize("shift", [(0, 0), (17, -20)])
def test_defocus_is_that_at_the_rim_of_the_aperture(tmp_path, w20, shift):
    pupil = {**saved(tmp_path, shift=shift), "defocus_waves": w20}
    expected = truth(w20)
    assert np.ptp(expected) > 0.05  # it tells
    np.testing.assert_allclose(mtf(tmp_path, pupil)[0, :16], np.abs(expected), atol=4e-3)


def test_a_typed_radius_is_centred_on_the_array(tmp_path):
    """Waves over a disc twice as wide are a quarter at the aperture's rim."""
    pupil = {**saved(tmp_path), "defocus_waves": 2.0, "radius": 2 * RADIUS}
    np.testing.assert_allclose(mtf(tmp_path, pupil)[0, :16], np.abs(truth(0.5)), atol=4e-3)


@pytest.mark.parametrize("shape", ["half_moon", "cassegrain"])
def test_a_file_is_as_the_shape_that_it_was_sampled_from(tmp_path, shape):
    waves = {"zernike_waves": [0, 0, 0, 0.05, 0.08, 0, 0.1]}
    geometric = {
        "shape": shape, "radius": RADIUS, "obscuration_radius": 0.0, "size_x": SIZE, "size_y": SIZE,
        **waves,
    }  # fmt: skip
    found = mtf(tmp_path, {**saved(tmp_path, shape), **waves})
    np.testing.assert_allclose(found, mtf(tmp_path, geometric), atol=8e-3)


@pytest.mark.parametrize(
    ("pupil", "expected"),
    [
        ({"shape": "clear"}, 75.0),
        ({"shape": "cassegrain", "radius": 60.0}, 60.0),
        ({"shape": "file", "path": "pupil.npy"}, 13.0),
        ({"shape": "file", "path": "pupil.npy", "radius": 20.0}, 20.0),
    ],
)
def test_the_radius_that_was_taken_is_read_out(tmp_path, pupil, expected):
    """Two open samples, 24 across and 10 along of one another: 26 apart, off the middle."""
    array = np.zeros((64, 64))
    array[10, 8] = array[20, 32] = 1.0
    np.save(tmp_path / "pupil.npy", array)
    bench = NodeBench(standard_library(), tmp_path, {"pupil": ("exit_pupil", pupil)})
    assert bench.plan.nodes["pupil"].declaration.readouts[0].unit == "samples"
    assert bench.readouts("pupil") == {"aperture_radius": pytest.approx(expected, abs=1e-9)}


def test_the_amplitude_of_a_file_is_relative_to_its_largest(tmp_path):
    array = np.zeros((64, 64))
    array[20:30, 20:40], array[30:40, 20:40] = 0.5, 0.2
    np.save(tmp_path / "pupil.npy", array)
    pupil = {"shape": "file", "path": "pupil.npy"}
    bench = NodeBench(standard_library(), tmp_path, {"pupil": ("exit_pupil", pupil)})
    np.testing.assert_allclose(np.abs(bench.value("pupil.pupil")), 2 * array, rtol=1e-12)
