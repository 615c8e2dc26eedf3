"""What a run writes, against arrays computed by other means."""

import csv
import json

import numpy as np
import pytest

from nodes.files.formats import read_pixels


def columns(path):
    with path.open() as file:
        rows = list(csv.reader(file))
    return {
        name: np.array([float(row[i]) for row in rows[1:] if row[i] != ""])
        for i, name in enumerate(rows[0])
    }


def test_writes_three_files(imagechain_process, write, small, tmp_path):
    done = imagechain_process("run", write(small))
    assert (done.returncode, done.stderr) == (0, "")
    written = {path.name for path in (tmp_path / "net-output").iterdir()}
    assert written == {"final.png", "mtf.csv", "readouts.json"}
    assert {path.name for path in tmp_path.iterdir()} == {"net.json", "net-output"}
    assert "MTF at the pixels' Nyquist" in done.stdout
    readouts = json.loads((tmp_path / "net-output/readouts.json").read_text())
    interval = 1000 * np.radians(3.0) / 48
    assert readouts["init"]["nyquist_x"] == pytest.approx(0.5 / interval, rel=1e-14)


def test_final_picture(imagechain, write, small, tmp_path):
    imagechain("run", write(small), "--save", "pixels.image=p.npy")
    levels = read_pixels(tmp_path / "net-output/final.png")
    exact = np.load(tmp_path / "p.npy").astype(float)
    assert levels.shape == (20, 24)
    low, high = np.percentile(exact, (0.1, 99.9))
    wanted = 255 * (np.clip(exact, low, high) - low) / (high - low)
    assert np.abs(levels - wanted).max() <= 0.5 + 1e-3


def test_mtf_csv(imagechain, write, small, tmp_path):
    imagechain("run", write(small))
    found = columns(tmp_path / "net-output/mtf.csv")
    dx, dy = 1000 * np.radians(3.0) / 48, 1000 * np.radians(2.5) / 40
    xi, eta = np.fft.rfftfreq(48, dx), np.fft.rfftfreq(40, dy)
    np.testing.assert_allclose(found["xi_cyc_per_mrad"], xi, rtol=1e-14)
    np.testing.assert_allclose(found["eta_cyc_per_mrad"], eta, rtol=1e-14)

    def blur(frequency, sigma):
        return np.exp(-2 * np.pi**2 * sigma**2 * frequency**2)

    for axis, frequency, sigma in (("x", xi, 0.5), ("y", eta, 0.3)):
        stages = {"blur": blur(frequency, sigma), "jitter": blur(frequency, 0.2)}
        stages["total"] = stages["blur"] * stages["jitter"]
        for name, wanted in stages.items():
            np.testing.assert_allclose(found[f"{name}.mtf_{axis}"], wanted, rtol=1e-12)
            assert not found[f"{name}.ptf_{axis}_rad"].any()


@pytest.mark.parametrize(("precision", "dtype"), [("single", np.float32), ("double", np.float64)])
def test_saves_every_format(precision, dtype, works, write, small, tmp_path):
    names = ["p.npy", "p.tif", "p.exr", "p.csv", "p.png"]
    words = [word for name in names for word in ("--save", f"pixels.image={name}")]
    works("run", write(small), "--precision", precision, *words)
    exact = np.load(tmp_path / "p.npy")
    assert exact.dtype == dtype
    assert exact.flags.c_contiguous
    assert exact.shape == (20, 24)
    np.testing.assert_array_equal(read_pixels(tmp_path / "p.tif"), exact)
    np.testing.assert_array_equal(read_pixels(tmp_path / "p.exr"), exact.astype(np.float32))
    np.testing.assert_array_equal(read_pixels(tmp_path / "p.csv").astype(dtype), exact)
    levels = read_pixels(tmp_path / "p.png")
    assert (levels.min(), levels.max()) == (0, 255)


def test_saves_every_port(imagechain, write, small, tmp_path):
    ports = ["scene.image", "init.magnitude", "init.phase", "blur.magnitude", "blur.mtf"]
    words = [word for port in ports for word in ("--save", f"{port}={port}.npy")]
    imagechain("run", write(small), "--precision", "double", *words, "--save", "init.context=c.csv")
    got = {port: np.load(tmp_path / f"{port}.npy") for port in ports}
    spectrum = np.fft.fft2(got["scene.image"])
    scale = np.abs(spectrum).max()
    np.testing.assert_allclose(got["init.magnitude"], np.abs(spectrum), atol=1e-13 * scale)
    rebuilt = got["init.magnitude"] * np.exp(1j * got["init.phase"])
    np.testing.assert_allclose(rebuilt, spectrum, atol=1e-13 * scale)
    xi = np.fft.fftfreq(48, 1000 * np.radians(3.0) / 48)
    eta = np.fft.fftfreq(40, 1000 * np.radians(2.5) / 40)[:, np.newaxis]
    mtf = np.exp(-2 * np.pi**2 * ((0.5 * xi) ** 2 + (0.3 * eta) ** 2))
    np.testing.assert_allclose(got["blur.mtf"], mtf, rtol=1e-12)
    np.testing.assert_allclose(got["blur.magnitude"], mtf * np.abs(spectrum), atol=1e-13 * scale)
    assert "focal_length_mm,100.0" in (tmp_path / "c.csv").read_text()


def test_threads_change_no_bit_and_seed_only_noise(imagechain, write, small, tmp_path):
    small["nodes"]["noise"] = {"module": "poisson_noise"}
    small["links"][0] = ["scene.image", "noise.image"]
    small["links"].append(["noise.image", "init.image"])
    write(small)
    for name, words in {
        "one": ["--threads", "1"],
        "two": ["--threads", "2"],
        "other": ["--seed", "4"],
        "same": ["--seed", "3"],
    }.items():
        imagechain("run", "net.json", *words, "--save", f"pixels.image={name}.npy")
    got = {n: (tmp_path / f"{n}.npy").read_bytes() for n in ("one", "two", "other", "same")}
    assert got["one"] == got["two"] == got["same"]
    assert got["one"] != got["other"]


def test_paths_are_relative_to_where_they_belong(works, write, small, tmp_path):
    (tmp_path / "nets").mkdir()
    frame = np.random.default_rng(1).random((40, 48))
    np.save(tmp_path / "nets/frame.npy", frame)
    small["nodes"]["scene"] = {
        "module": "read_image",
        "params": {"path": "frame.npy", "fov_x_deg": 3.0, "fov_y_deg": 2.5},
    }
    small["nodes"]["out"] = {"module": "write_image", "params": {"path": "out.tif"}}
    small["links"].append(["back.image", "out.image"])
    write(small, "nets/net.json")
    words = ["--save", "scene.image=copy.npy", "--output-dir", "a/b", "--precision", "double"]
    works("run", "nets/net.json", *words)
    np.testing.assert_array_equal(np.load(tmp_path / "copy.npy"), frame)
    assert (tmp_path / "nets/out.tif").is_file()
    assert (tmp_path / "a/b/final.png").is_file()
