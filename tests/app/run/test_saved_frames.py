"""``--frames N``: frames of a saved image, each with temporal noise of its own."""

from __future__ import annotations

import os
import shlex
import shutil
import sys

import numpy as np
import pytest

from child_process import ROOT, finished


@pytest.fixture
def noisy(small, write):
    """A network whose pixels have amplifier noise and a fixed pattern."""
    small["nodes"]["init"]["params"] |= {"detector_x_um": 30.0, "detector_y_um": 30.0}
    small["nodes"]["init"]["params"] |= {"f_number": 2.0, "platform": "array"}
    small["nodes"]["electronics"] = {
        "module": "electronics_noise",
        "params": {
            "region": "LWIR",
            "bandwidth_Hz": 1000.0,
            "amplifier_snr": 20.0,
            "gain_percent": 5.0,
        },
    }
    small["links"] += [
        ["init.context", "electronics.context"],
        ["pixels.image", "electronics.image"],
    ]
    return write(small)


def test_frames_of_a_picture(imagechain, noisy, tmp_path):
    done = imagechain("run", noisy, "--frames", "7", "--save", "electronics.image=f.npy")
    assert done.returncode == 0, done.stderr
    assert imagechain("run", noisy, "--save", "electronics.image=one.npy").returncode == 0
    frames, one = np.load(tmp_path / "f.npy"), np.load(tmp_path / "one.npy")
    assert frames.shape == (7, 20, 24)
    assert frames.dtype == np.float32
    assert np.array_equal(frames[0], one)
    changes = np.diff(frames, axis=0).std(axis=(1, 2))
    sigma = one.mean() / 20.0
    assert changes == pytest.approx(np.sqrt(2) * sigma, rel=0.15)


def test_a_region_of_frames_is_cut_from_them(imagechain, noisy, tmp_path):
    done = imagechain(
        "run", noisy, "--frames", "3", "--save", "electronics.image=f.npy",
        "--save", "electronics.image[2:9,5:]=part.npy", "--save", "electronics.table=t.csv",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    whole, part = np.load(tmp_path / "f.npy"), np.load(tmp_path / "part.npy")
    assert np.array_equal(part, whole[:, 2:9, 5:])
    assert (tmp_path / "t.csv").exists()


_OWN_MOUNTS = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c"]


@pytest.mark.parametrize("frames", ["--frames=200", "--seed=1"])
def test_a_disk_that_is_full(frames, noisy, tmp_path):
    """2.5 times what it holds in all, or a single file too many, written as the frames come."""
    (tmp_path / "full").mkdir()
    mount = "mount -t tmpfs -o size={} tmpfs full"
    tried = shutil.which("unshare") and finished(
        [*_OWN_MOUNTS, mount.format("1m")], folder=tmp_path
    )
    if not tried or tried.returncode:
        pytest.skip("no file system of a given size can be made here")
    size, port = ("150k", "electronics.image") if "200" in frames else ("4k", "init.magnitude")
    command = [sys.executable, "-m", "app.command.cli", "run", str(noisy), frames]
    command += ["--save", f"{port}=full/f.npy"]
    line = f"{mount.format(size)} && {{ {shlex.join(command)}; "
    line += 'code=$?; ls -A full; exit "$code"; }'
    done = finished(
        [*_OWN_MOUNTS, line], folder=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)}
    )
    assert (done.returncode, done.stdout) == (2, ""), done
    node = port.partition(".")[0]
    assert done.stderr == f"imagechain: {node}: cannot write full/f.npy: No space left on device\n"


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            ("--frames", "2", "--save", "electronics.image=f.tif"),
            "--save electronics.image=f.tif: --frames of an image need a .npy",
        ),
        (("--frames", "0"), "--frames 0: give a whole number from 1 to 1000000"),
        (("--frames", "2000000"), "--frames 2000000: give a whole number from 1 to 1000000"),
        (("--frames", "many"), "--frames 'many': give a whole number"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_runs(fails, noisy, words, line):
    assert fails("run", noisy, *words) == f"imagechain: {line}\n"
