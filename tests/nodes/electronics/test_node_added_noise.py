"""Periodic Noise and Noise File."""

import numpy as np
import pytest

from core.errors import DataError, FileError, ParameterError
from node_bench import NodeBench

FOV = {"fov_x_deg": 2.0, "fov_y_deg": 1.5}


def picture(rows=31, columns=44, seed=1):
    return np.random.default_rng(seed).uniform(20, 60, (rows, columns))


def planned(folder, key, params):
    np.save(folder / "in.npy", picture())
    nodes = {"in": ("read_image", {"path": "in.npy", **FOV}), "out": (key, params)}
    return NodeBench(folder, nodes)


def outputs(folder, key, params):
    bench = planned(folder, key, params)
    return bench.value("out.image"), bench.value("out.noise")


def test_modulation(tmp_path):
    params = {"amplitude": 1.0, "xi": 0.4, "modulation": 0.5, "modulation_eta": 0.05}
    params |= {"modulation_xi": 0.02, "modulation_phase_deg": 45.0}
    _, noise = outputs(tmp_path, "periodic_noise", params)
    y, x = np.mgrid[:31, :44].astype(float)
    x *= np.radians(2.0) * 1000 / 44
    y *= np.radians(1.5) * 1000 / 31
    envelope = 1 + 0.5 * np.sin(2 * np.pi * (0.02 * x + 0.05 * y) + np.pi / 4)
    np.testing.assert_allclose(noise, envelope * np.sin(2 * np.pi * 0.4 * x), atol=1e-12)
    _, plain = outputs(tmp_path, "periodic_noise", {"amplitude": 1.0, "xi": 0.4})
    np.testing.assert_allclose(plain, np.sin(2 * np.pi * 0.4 * x), atol=1e-12)


def test_noise_file_is_added_with_its_scale(tmp_path):
    cube = np.random.default_rng(3).normal(size=(31, 44, 2))
    np.save(tmp_path / "noise.npy", cube)
    image, noise = outputs(tmp_path, "noise_file", {"path": "noise.npy", "band": 1, "scale": 0.5})
    np.testing.assert_array_equal(noise, 0.5 * cube[:, :, 1])
    np.testing.assert_array_equal(image, picture() + noise)


@pytest.mark.parametrize(
    ("params", "kind", "words"),
    [
        ({}, ParameterError, "path"),
        (
            {"path": "small.npy"},
            DataError,
            "small.npy has 30 × 31 samples and the picture has 44 × 31",
        ),
        ({"path": "small.npy", "band": 2}, FileError, "no band 2"),
        ({"path": "none.npy"}, FileError, "no such file"),
    ],
)
def test_faults_of_the_noise_file(tmp_path, params, kind, words):
    np.save(tmp_path / "small.npy", picture(31, 30))
    error = planned(tmp_path, "noise_file", params).error("out")
    assert isinstance(error, kind)
    assert words in str(error)
    assert error.node == "out"
