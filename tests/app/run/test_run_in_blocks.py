"""``imagechain run --memory``: the same files, with pictures on disk."""

import json
import resource

import numpy as np
import pytest
import zarr

from app.run.shipped import find_network
from linked_network import document_of
from nodes.files.formats import read_pixels

BUDGET = "100kB"
LIMIT = 20_000  # bytes that a file may have
NETWORKS = {
    "kodak_kir310": {"scene": (97, 89)},
    "inframetrics": {"scene": (90, 101)},
    "poisson_two_panel": {"scene": (61, 67)},
    "pushbroom_banding": {"scene": (96, 81)},
    "first_steps": {"scene": (83, 96)},
    "dirsig_cube": {},  # bands of a file, filtered each at its own wavelength
}


def assert_same_bits(works, folder, *words):
    """A run in memory and one in blocks write the same."""
    for name, memory in (("a", "8GB"), ("b", BUDGET)):
        done = works(*words, "--memory", memory, "--output-dir", name)
        assert ("in blocks: " in done.stdout) == (name == "b")
    for file in ("readouts.json", "mtf.csv", "final.png"):
        assert (folder / "a" / file).read_bytes() == (folder / "b" / file).read_bytes()


@pytest.mark.thorough(but=4)
@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("name", NETWORKS)
def test_shipped_networks_to_the_bit(works, tmp_path, name, precision):
    sizes = [
        word
        for node, (width, height) in NETWORKS[name].items()
        for word in (f"--set={node}.width={width}", f"--set={node}.height={height}")
    ]
    edges = ["--set=init.edges=periodic"] if precision == "double" and "two_" not in name else []
    words = ["run", name, *sizes, *edges, "--precision", precision]
    assert_same_bits(works, tmp_path, *words)


@pytest.mark.parametrize("rows", [60, 1024])  # of few samples, surfaces are drawn once
def test_a_test_scene_in_bands(works, write, tmp_path, rows):
    scene = {"width": 1300, "height": rows, "bands": 2, "quantity": "reflectance"}
    nodes = {
        "scene": ("test_scene", scene | {"cut_on_um": 0.4, "cut_off_um": 0.7}),
        "light": ("reflected_light", {}),
    }
    network = write(document_of(nodes))
    for memory in ("8GB", BUDGET):
        words = ("--save", f"light.image={memory}.npy", "--memory", memory)
        done = works("run", network, *words, "--output-dir", memory)
        assert ("in blocks: " in done.stdout) == (memory == BUDGET)
    assert (tmp_path / "8GB.npy").read_bytes() == (tmp_path / f"{BUDGET}.npy").read_bytes()


@pytest.mark.parametrize("binning", ["charge", "digital"])
def test_bins_and_multiplied_charge_of_a_focal_plane_to_the_bit(works, tmp_path, binning):
    given = {
        "scene.width": 194, "scene.height": 178, "camera.pixels_x": 97, "camera.pixels_y": 89,
        "focal_plane.charge_gain": "em_register", "focal_plane.charge_gain_factor": 100,
        "focal_plane.bad_pixel_percent": 2, "focal_plane.binning": binning,
        "focal_plane.binning_x": 2, "focal_plane.binning_y": 3,
    }  # fmt: skip
    words = [f"--set={name}={value}" for name, value in given.items()]
    words += ["--disable", "budget", "--disable", "merit"]  # these need whole pictures
    assert_same_bits(works, tmp_path, "run", "mwir_camera", *words)


def test_geometry_convolution_and_measurements(works, write, tmp_path):
    """What takes its picture as it lies on disk: footprints, tap by tap, a region, mean rows."""
    document = json.loads(find_network("measured_mtf").path.read_text())
    nodes, links = document["nodes"], document["links"]
    nodes["scene"]["params"] |= {"width": 150, "height": 131}
    nodes["measured"]["params"] |= {
        "region_x": 60, "region_y": 32, "region_width": 32, "region_height": 64,
    }  # fmt: skip
    nodes["ground"] = {
        "module": "camera_geometry",
        "params": {
            "kind": "framing", "altitude_m": 100.0, "fov_x_deg": 60.0, "rows": 101, "columns": 103,
            "ground_interval_m": 1.0, "yaw_deg": 20.0, "outside": "fill",
        },
    }  # fmt: skip
    nodes["photons"] = {"module": "poisson_noise"}
    nodes["space"] = {"module": "spatial_blur", "params": {"half_width_px": 5}}
    nodes["axes"] = {"module": "compare_images", "params": {"average": "axes"}}
    links += [["scene.image", "ground.image"], ["scene.image", "photons.image"]]
    links += [["detector.magnitude", "space.magnitude"], ["init.phase", "space.phase"]]
    links += [["space.image", "axes.image"], ["scene.image", "axes.reference"]]
    network = write(document)
    ports = ("ground.image", "ground.coverage", "space.image")
    saves = [f"--save={port}={{}}_{port}.npy" for port in ports]
    saves += [f"--save={name}.curve={{}}_{name}.csv" for name in ("axes", "measured")]
    for folder, memory in (("a", "8GB"), ("b", "150kB")):
        words = [word.format(folder) for word in saves]
        done = works("run", network, *words, "--memory", memory, "--output-dir", folder)
        assert ("in blocks: " in done.stdout) == (folder == "b")
    names = [word.rpartition("=")[2] for word in saves]
    for name in ("{}/readouts.json", *names):
        a, b = (tmp_path / name.format(folder) for folder in "ab")
        assert a.read_bytes() == b.read_bytes()


def noisy(small):
    """With a file's scene, every kind of step, and a picture that is walked through twice."""
    small["nodes"]["scene"] = {
        "module": "read_image",
        "params": {"path": "scene.npy", "fov_x_deg": 3.0, "fov_y_deg": 2.5},
    }
    small["nodes"]["pixels"]["params"] = {"factor_x": 2, "factor_y": 3}
    small["nodes"]["noise"] = {
        "module": "electronics_noise",
        "params": {
            "cut_on_um": 3.0, "cut_off_um": 5.0, "d_star": 1e11, "amplifier_snr": 50.0,
            "bits": 12, "gain_percent": 1.0, "bias_percent": 1.0, "use_mtf": True,
            "bandwidth_Hz": 1e5,
        },
    }  # fmt: skip
    small["nodes"]["init"]["params"] |= {
        "detector_x_um": 20.0, "detector_y_um": 20.0, "f_number": 2.0, "fill_x": 1.0,
        "fill_y": 1.0, "platform": "push", "scan_velocity_mrad_per_s": 1e4,
    }  # fmt: skip
    small["links"] += [["pixels.image", "noise.image"], ["init.context", "noise.context"]]
    return small


@pytest.fixture
def scene(tmp_path):
    """As a file, and cut into chunks that are no multiples of the blocks it is read in."""
    samples = np.random.default_rng(3).uniform(5.0, 15.0, (99, 84)).astype(np.float32)
    np.save(tmp_path / "scene.npy", samples)
    store = zarr.create_array(
        tmp_path / "scene.zarr", shape=samples.shape, dtype="<f4", chunks=(31, 40)
    )
    store[...] = samples
    return samples


@pytest.mark.parametrize(("edges", "file"), [("reflect", "scene.npy"), ("periodic", "scene.zarr")])
def test_saved_pictures_are_streamed(imagechain, works, small, write, scene, tmp_path, edges, file):
    network = write(noisy(small))
    words = ["run", network, "--set=scene.path=scene.npy", f"--set=init.edges={edges}", "--save"]
    assert imagechain(*words, "noise.image=whole.npy", "--memory", "8GB").returncode == 0
    whole = np.load(tmp_path / "whole.npy")
    more = [f"--save=noise.image=in.{kind}" for kind in ("tif", "img", "zarr")]
    words[2] = f"--set=scene.path={file}"
    budget = ("--memory", "50kB", "--scratch", ".", "--report", "r.json", "--report", "r.html")
    works(*words, "noise.image=in.npy", *more, *budget)
    for kind in ("npy", "tif", "img", "zarr"):
        np.testing.assert_array_equal(read_pixels(tmp_path / f"in.{kind}"), whole)
    way = json.loads((tmp_path / "r.json").read_text())["run"]["way"]
    assert (way["way"], way["largest_rows"], way["memory_bytes"]) == ("in blocks", 99, 50_000)
    # A scene and its spectrum at least lay on disk at a time.
    assert way["scratch_bytes"] >= 2 * 4 * scene.size
    assert "in blocks: pictures of 99 × 84 samples" in (tmp_path / "r.html").read_text()
    assert not list(tmp_path.glob(".imagechain*"))


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (
            ["--save", "back.image=b.png"],
            "--save back.image=b.png: a picture of 99 × 84 samples that is computed in blocks "
            "must be written as .npy, .tif, .tiff, .bsq, .img, .zarr",
        ),
        (
            ["--save", "blur.magnitude=b.npy"],
            "--save blur.magnitude: a magnitude of 99 × 84 samples must be computed all at once "
            "but does not fit in --memory 50 kB",
        ),
        (["--scratch", "away"], "cannot write to the scratch folder away: No such file or dir"),
    ],
)
def test_one_line(fails, small, write, scene, words, line):
    budget = [] if "--memory" in words else ["--memory", "50kB"]
    assert line in fails("run", write(noisy(small)), *budget, *words)


def test_a_disk_without_room(fails, small, write, scene):
    """A limit on files' sizes refuses as a full disk does."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    network = write(noisy(small))
    resource.setrlimit(resource.RLIMIT_FSIZE, (LIMIT, before[1]))
    try:
        line = fails("run", network, "--memory", "50kB", "--scratch", ".")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert "the scratch folder . has no room for another" in line
