"""PSF File: which way round it lies, its scale and formats, and what it refuses."""

import numpy as np
import pytest
from scipy.ndimage import convolve

from command_line import run_here
from core.network.file import format_network
from linked_network import in_order
from node_bench import NodeBench, fov_of
from nodes.library import standard_library

FOCAL_LENGTH_MM = 100.0
INTERVAL_MRAD = 0.05
WIDTH, HEIGHT = 65, 49
FOV = fov_of((HEIGHT, WIDTH), INTERVAL_MRAD)
SCENE = {"kind": "point", "width": WIDTH, "height": HEIGHT, **FOV}
COMET = np.zeros((7, 9))
COMET[3, 4], COMET[3, 5:], COMET[4:, 4], COMET[1, 1] = 10.0, (5, 4, 3, 1), (3, 1, 0.5), 0.7


def planned(folder, params, *, focal_length_mm=FOCAL_LENGTH_MM, phase="it.phase"):
    nodes = {
        "scene": ("test_scene", SCENE),
        "init": ("init_trans", {"edges": "periodic", "focal_length_mm": focal_length_mm}),
        "it": ("psf_file", params),
        "back": ("back_transform", {}),
    }
    links = in_order(nodes)
    if phase != "it.phase":
        links = [link for link in links if "it.phase" not in link] + [(phase, "back.phase")]
    return NodeBench(folder, nodes, links, tolerance=0.0)


def value(folder, params, port="back.image", **how):
    return planned(folder, params, **how).value(port)


def refusal(folder, params, **how):
    return planned(folder, params, **how).refusal("back.image", "it")


PITCH = {"sample_pitch": INTERVAL_MRAD, "pitch_unit": "mrad"}


def test_a_run_lays_it_over_a_point_as_it_is_seen(tmp_path):
    """`imagechain run` of a point; the tail to the right is to the right, the one below below."""
    np.save(tmp_path / "comet.npy", COMET)
    made = planned(tmp_path, {"path": "comet.npy", **PITCH}).plan.network
    text = format_network(made, library=standard_library())
    (tmp_path / "net.json").write_text(text, encoding="utf-8")
    done = run_here(
        "run", "net.json", "--precision=double", "--tolerance=0", "--output-dir=out",
        "--save=back.image=seen.npy", "--save=scene.image=scene.npy", folder=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    scene, seen = np.load(tmp_path / "scene.npy"), np.load(tmp_path / "seen.npy")
    dark = np.median(scene)
    row, column = np.unravel_index(np.argmax(scene), scene.shape)
    light = seen - dark
    assert light[row, column + 3] > 5 * abs(light[row, column - 3])
    assert light[row + 1, column] > 5 * abs(light[row - 1, column])
    assert light[row - 2, column - 3] > 0.01 * light.max()
    # Odd sizes have no frequency at Nyquist: the Fourier way is the convolution, to rounding.
    wanted = convolve(scene, COMET / COMET.sum(), mode="wrap")
    np.testing.assert_allclose(seen, wanted, atol=1e-12 * scene.max())


def test_the_centroid_is_kept_or_removed(tmp_path):
    """Of a point moved by (3, −2) samples in its file; kept it moves the picture, removed not."""
    moved = np.roll(np.pad(np.outer([1, 2, 1], [1, 4, 1.0]), 5), (-2, 3), axis=(0, 1))
    np.save(tmp_path / "psf.npy", moved)
    params = {"path": "psf.npy", **PITCH}
    kept, removed = (value(tmp_path, {**params, "centroid": c}) for c in ("kept", "removed"))
    np.testing.assert_allclose(kept, np.roll(removed, (-2, 3), axis=(0, 1)), rtol=1e-9)
    found = planned(tmp_path, params).readouts("it")
    assert found["centre_x_mrad"] == pytest.approx(3 * INTERVAL_MRAD)
    assert found["centre_y_mrad"] == pytest.approx(-2 * INTERVAL_MRAD)
    assert found["sum_of_samples"] == pytest.approx(24.0)
    assert found["file_nyquist_x"] == pytest.approx(10.0)


def test_micrometres_at_the_focal_plane_and_unequal_samples(tmp_path):
    """A file at half the interval along, every other row of it empty but the middle's, is one at
    the whole interval."""
    fine = np.zeros((2 * COMET.shape[0] - 1, COMET.shape[1]))
    fine[::2] = COMET
    np.save(tmp_path / "fine.npy", fine)
    np.save(tmp_path / "coarse.npy", COMET)
    um = INTERVAL_MRAD * FOCAL_LENGTH_MM
    params = {"path": "fine.npy", "sample_pitch": um, "sample_pitch_y": um / 2}
    got = value(tmp_path, params)
    np.testing.assert_allclose(got, value(tmp_path, {"path": "coarse.npy", **PITCH}), rtol=1e-9)
    own = value(tmp_path, {**params, "focal_length_mm": FOCAL_LENGTH_MM}, focal_length_mm=None)
    np.testing.assert_array_equal(own, got)


LENGTHS = {"µm": 1.0, "nm": 1e-3, "mm": 1e3, "millimeter": 1e3, "millimeters": 1e3}


@pytest.mark.parametrize(("unit", "um"), LENGTHS.items())
def test_zemax_listing_with_its_spacing(tmp_path, unit, um):
    rows = "\r\n".join("\t".join(f"{v: .4E}" for v in row) for row in COMET)
    text = (
        "Listing of FFT PSF Data\r\n\r\nFile : C:\\lens.ZMX\r\nTitle: \r\nDate : 1/1/2026\r\n\r\n"
        "Polychromatic FFT PSF\r\n3.7000 to 4.8000 µm at 0.0000, 0.0000 (deg).\r\n"
        f"Data spacing is {INTERVAL_MRAD * FOCAL_LENGTH_MM / um:.9g} {unit}.\r\n"
        "Data area is 45 µm wide.\r\n"
        "Strehl ratio: 0.9\r\nPupil grid size: 32 by 32\r\nImage grid size: 9 by 7\r\n"
        "Center point is: 5, 4\r\n\r\nValues are relative intensity.\r\n\r\n"
    )  # fmt: skip
    (tmp_path / "psf.txt").write_bytes((text + rows + "\r\n").encode("utf-16"))
    np.save(tmp_path / "psf.npy", COMET)
    wanted = value(tmp_path, {"path": "psf.npy", **PITCH})
    np.testing.assert_allclose(value(tmp_path, {"path": "psf.txt"}), wanted, rtol=1e-12)
    (tmp_path / "psf.txt").write_bytes((text + rows[: len(rows) // 2] + "\r\n").encode("utf-16"))
    assert "line 2" in refusal(tmp_path, {"path": "psf.txt"})


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("a.txt", b"", "the file is empty"),
        ("a.txt", b"point spread\nfunction\n", "contains no matrix of numbers"),
        ("a.txt", b"1 2 3\n4 5\n", "line 2 has 2 numbers; allowed: 3"),
        ("a.txt", b"1 2 3\n4 nan 5\n", "1 sample is not finite"),
        ("a.txt", b"0 0 0\n0 0 0\n", "sum to 0; allowed: above 0"),
        ("a.txt", bytes(range(256)), "not a text file with a matrix of numbers"),
        ("a.txt", b"0 " * 5000 + b"1\n", "5001 × 1 samples; at most 4096 on a side"),
        ("a.npy", b"\x93NUMPY\x01\0 and no more", "damaged or truncated"),
        ("a.png", b"\x89PNG\r\n\x1a\nnothing", "a.png"),
        ("a.dat", b"\x00\x01\x02\xff" * 99, "a.dat"),
    ],
)
def test_bad_files_are_one_clear_line(tmp_path, name, content, words):
    (tmp_path / name).write_bytes(content)
    message = refusal(tmp_path, {"path": name, **PITCH})
    assert words in message
    assert name in message
    assert len(message) < 400


def test_of_several_bands_one_is_chosen(tmp_path):
    np.save(tmp_path / "psf.npy", COMET)
    np.save(tmp_path / "cube.npy", np.stack([COMET[::-1], COMET], axis=-1))
    assert "cube.npy has 2 bands; choose 0 to 1" in refusal(tmp_path, {"path": "cube.npy", **PITCH})
    chosen = value(tmp_path, {"path": "cube.npy", "band": 1, **PITCH})
    np.testing.assert_array_equal(chosen, value(tmp_path, {"path": "psf.npy", **PITCH}))
    first = value(tmp_path, {"path": "cube.npy", "band": 0, **PITCH})
    assert np.abs(first - chosen).max() > 0.01 * chosen.max()


def cautions(folder, params, **how):
    bench = planned(folder, params, **how)
    assert bench.plan.errors() == []
    return {one.check: one.text for one in bench.warnings() if one.node == "it"}


def test_warns_of_energy_at_the_border_of_coarse_samples_and_of_no_file(tmp_path):
    place = np.arange(31) - 15
    smooth = np.exp(-(place[None, :] ** 2 + place[:, None] ** 2) / 8.0)  # σ = 2: 3e-9 at Nyquist
    np.save(tmp_path / "psf.npy", smooth)
    params = {"path": "psf.npy", **PITCH}
    assert cautions(tmp_path, params) == {}
    # A background b of 961 samples beside a sum of 8π: b·961/(b·961 + 25.13) of the energy.
    np.save(tmp_path / "psf.npy", smooth + 0.001)
    found = cautions(tmp_path, params)
    assert set(found) == {"border"}
    assert "3.68 % of the energy" in found["border"]
    assert cautions(tmp_path, {**params, "background": 0.001}) == {}
    # Every third sample of it has σ = 2/3: exp(−2π²·(2/3)²/4) = 0.1116 at Nyquist, from both sides.
    np.save(tmp_path / "psf.npy", smooth[::3, ::3])
    found = cautions(tmp_path, params)
    assert set(found) == {"coarse"}
    assert "MTF is still 0.2" in found["coarse"]
    assert "path is empty" in cautions(tmp_path, {})["no_file"]
    np.save(tmp_path / "psf.npy", smooth)
    params = {"path": "psf.npy", "sample_pitch": 5.0, "focal_length_mm": 50.0}
    assert "50 mm here but 100 mm" in cautions(tmp_path, params)["geometry"]
    assert "PTF is left out" in cautions(tmp_path, params, phase="init.phase")["no_phase"]
