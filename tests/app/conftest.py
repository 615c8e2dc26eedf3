import json
from functools import partial
from pathlib import Path

import pytest

from command_line import run_here, run_process
from linked_network import document_of

EDGE = {"kind": "slanted_edge", "width": 48, "height": 40, "fov_x_deg": 3.0, "fov_y_deg": 2.5}
NODES = {
    "scene": ("test_scene", EDGE),
    "init": ("init_trans", {"focal_length_mm": 100.0}),
    "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.5, "sigma_y_mrad": 0.3}),
    "jitter": ("jitter_mtf", {"sigma_mrad": 0.2}),
    "back": ("back_transform", {}),
    "pixels": ("combine_pixels", {"factor_x": 2, "factor_y": 2}),
}


@pytest.fixture
def small() -> dict:
    return document_of(NODES, name="Small", seed=3)


@pytest.fixture
def two(small) -> dict:
    """Two ends: the pixels, and noise on a picture of its own."""
    small["nodes"] |= {
        "other": {"module": "test_scene", "params": {"width": 16, "height": 16}},
        "noisy": {"module": "poisson_noise"},
    }
    small["links"].append(["other.image", "noisy.image"])
    return small


@pytest.fixture
def write(tmp_path):
    """Write a network file into the folder the command runs in."""

    def save(document, name="net.json"):
        (tmp_path / name).write_text(json.dumps(document))
        return name

    return save


@pytest.fixture
def imagechain(tmp_path):
    """Run the command in `tmp_path`."""
    return partial(run_here, folder=tmp_path)


@pytest.fixture
def works(imagechain):
    """Run a command that must succeed, and say nothing of errors."""

    def run(*words, **how):
        done = imagechain(*words, **how)
        assert (done.returncode, done.stderr) == (0, "")
        return done

    return run


@pytest.fixture
def imagechain_process(tmp_path):
    """Run the command in `tmp_path` as a user does, where the process itself matters."""
    return partial(run_process, folder=tmp_path)


@pytest.fixture
def fails(imagechain, tmp_path):
    """Run a command that must fail with one line, and write nothing."""

    def run(*words, code=2):
        before = everything(tmp_path)
        done = imagechain(*words)
        assert done.returncode == code, done.stderr
        assert done.stderr.endswith("\n")
        assert done.stderr.count("\n") == 1, done.stderr
        assert everything(tmp_path) == before
        return done.stderr

    return run


def everything(folder: Path) -> dict[str, bytes | None]:
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None
        for path in sorted(folder.rglob("*"))
    }
