"""``--frames N``: frames of a saved image, each with temporal noise of its own."""

import os
import shlex
import shutil
import sys

import numpy as np
import pytest
from PIL import Image as Pillow

from child_process import PEAK, ROOT, finished
from nodes.files.formats import read_info, read_pixels


@pytest.fixture
def noisy(small, write):
    """A network whose pixels have amplifier noise and a fixed pattern."""
    small["nodes"]["init"]["params"] |= {"detector_x_um": 30.0, "detector_y_um": 30.0}
    small["nodes"]["init"]["params"] |= {"f_number": 2.0, "platform": "array"}
    noise = {"region": "LWIR", "bandwidth_Hz": 1e3, "amplifier_snr": 20.0, "gain_percent": 5.0}
    small["nodes"]["electronics"] = {"module": "electronics_noise", "params": noise}
    small["links"].append(["init.context", "electronics.context"])
    small["links"].append(["pixels.image", "electronics.image"])
    return write(small)


def test_frames_of_a_picture(imagechain, works, noisy, tmp_path):
    works("run", noisy, "--frames", "7", "--save", "electronics.image=f.npy")
    assert imagechain("run", noisy, "--save", "electronics.image=one.npy").returncode == 0
    frames, one = np.load(tmp_path / "f.npy"), np.load(tmp_path / "one.npy")
    assert frames.shape == (7, 20, 24)
    assert frames.dtype == np.float32
    assert np.array_equal(frames[0], one)
    changes = np.diff(frames, axis=0).std(axis=(1, 2))
    sigma = one.mean() / 20.0
    assert changes == pytest.approx(np.sqrt(2) * sigma, rel=0.15)


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
    if "200" in frames:
        # 200 × 20 × 24 samples of 4 bytes and the header of a .npy; 150 kB less what is taken.
        line = "cannot write full/f.npy: 200 frames of 20 × 24 samples take 384 kB, but only"
        assert done.stderr.startswith(f"imagechain: {line} 15")
        assert done.stderr.count("\n") == 1
    else:
        line = f"{node}: cannot write full/f.npy: No space left on device"
        assert done.stderr == f"imagechain: {line}\n"


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            "--frames=2 --save=electronics.image=f.exr",
            "--save electronics.image=f.exr: with --frames, an image must be written as "
            ".npy, .tif, .tiff, .bsq, .img\n",
        ),
        (
            "--frames=1000000 --save=electronics.image=f.npy --set=scene.width=65536 "
            "--set=scene.height=65536",
            "1000000 frames of 32768 × 32768 samples take 4.29e+06 GB",
        ),
        (
            "--frames=2000000",
            "--frames 2000000 is not allowed: must be a whole number from 1 to 1000000\n",
        ),
    ],
)
def test_what_cannot_be_is_refused_before_anything_runs(fails, noisy, tmp_path, words, line):
    assert line in fails("run", noisy, *words.split())
    assert [path.name for path in tmp_path.iterdir()] == ["net.json"]


CAMERA = {
    "integration_time_s": 1e-4, "read_noise_e": 500.0, "dsnu_e": 200.0, "prnu_percent": 1.0,
    "full_well_e": 3e7, "bits": 12, "bad_pixel_percent": 2.0,
}  # fmt: skip
SAVES = [f"--save=camera.image={name}" for name in ("f.npy", "f.tif", "f.bsq")]


@pytest.fixture
def camera(small, write):
    small["nodes"]["init"]["params"] |= {"detector_x_um": 30.0, "detector_y_um": 30.0}
    small["nodes"]["init"]["params"] |= {"f_number": 2.0, "platform": "array"}
    small["nodes"]["camera"] = {"module": "focal_plane", "params": CAMERA}
    small["nodes"]["file"] = {"module": "write_image", "params": {"path": "written.tif"}}
    small["links"] += [["init.context", "camera.context"], ["pixels.image", "camera.image"]]
    small["links"].append(["camera.image", "file.image"])
    return write(small)


def test_a_twelve_bit_tiff_holds_0_to_4095(works, camera, tmp_path):
    """Digital numbers in integer files are as they are, not stretched."""
    names = ("image=n.npy", "image=saved.tif", "saturated=s.npy", "table=t.csv")
    works("run", camera, *(f"--save=camera.{name}" for name in names))
    numbers = np.load(tmp_path / "n.npy")
    assert (numbers.min(), numbers.max()) == (0.0, 4095.0)  # a dead pixel, and a hot one
    assert len(np.unique(numbers)) > 50
    for name in ("saved.tif", "written.tif"):
        assert read_info(tmp_path / name).dtype == "uint16"
        np.testing.assert_array_equal(read_pixels(tmp_path / name), numbers)
    marked = np.load(tmp_path / "s.npy")
    assert marked.sum() == (numbers == 4095).sum()
    assert f"saturated_pixels,{int(marked.sum())}" in (tmp_path / "t.csv").read_text()


def test_all_formats_hold_the_same_numbers(works, camera, tmp_path):
    works("run", camera, "--frames", "4", *SAVES, "--save=camera.image[3:8,2:]=p.img")
    frames = np.load(tmp_path / "f.npy")
    assert frames.dtype == np.float32
    with Pillow.open(tmp_path / "f.tif") as picture:
        assert picture.n_frames == 4
        for number in range(4):
            picture.seek(number)
            page = np.asarray(picture)
            assert page.dtype == np.uint16
            np.testing.assert_array_equal(page, frames[number])
    np.testing.assert_array_equal(
        np.fromfile(tmp_path / "f.bsq", "<u2").reshape(frames.shape), frames
    )
    part = np.fromfile(tmp_path / "p.img", "<u2").reshape(4, 5, 22)
    np.testing.assert_array_equal(part, frames[:, 3:8, 2:])
    assert "data units = DN\n" in (tmp_path / "p.img.hdr").read_text()
    assert (read_info(tmp_path / "f.bsq").bands, read_info(tmp_path / "f.tif").unit) == (4, "DN")


def test_many_frames_take_the_memory_of_ten(camera, tmp_path):
    """Kept, the pictures that lead to 1500 frames of 480 samples would be 15 MB and more."""
    code = f"from app.command.cli import main\ncode = main()\nprint(code, end=' ')\n{PEAK}"
    peaks = {}
    for frames in (10, 1500):
        words = ["run", str(camera), f"--frames={frames}", *SAVES]
        done = finished(
            [sys.executable, "-c", code, *words],
            folder=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)},
        )  # fmt: skip
        exit_code, peak = done.stdout.splitlines()[-1].split()
        assert exit_code == "0", done
        peaks[frames] = int(peak) / 1024
    assert peaks[1500] < peaks[10] + 5.0


# --- bands ---


@pytest.fixture
def banded(small, write):
    small["nodes"]["scene"]["params"] |= {"bands": 6, "cut_on_um": 3.0, "cut_off_um": 5.0}
    return write(small)


def test_bands_of_a_filtered_picture(works, banded, tmp_path):
    works("run", banded, "--save", "back.image=b.img", "--save", "back.image=b.npy")
    whole = np.load(tmp_path / "b.npy")
    info = read_info(tmp_path / "b.img")
    assert (info.rows, info.columns, info.bands) == (*whole.shape, 6)
    assert info.unit == "W/m^2/sr/um"
    assert info.wavelengths_um == pytest.approx(3.0 + (np.arange(6) + 0.5) / 3)
    assert info.fwhm_um == pytest.approx([1 / 3] * 6)
    bands = [read_pixels(tmp_path / "b.img", index) for index in range(6)]
    np.testing.assert_allclose(np.sum(bands, axis=0) / 3, whole, rtol=1e-5)
