import tracemalloc

import numpy as np
import pytest

from child_process import kill_program, run_program
from core.errors import DataError, FileError, ParameterError
from nodes.files.common.stored_samples import as_stored
from nodes.files.formats import write_picture
from nodes.files.pictures import read_band, read_info
from nodes.files.read import read_pixels
from picture_samples import SPECIAL


@pytest.mark.parametrize(
    ("name", "dtype", "numpy_type"),
    [
        ("a.tif", "float", np.float32),
        ("a.tiff", "double", np.float64),
        ("a.exr", "float", np.float32),
        ("a.exr", "half", np.float16),
    ],
)
def test_floats_read_back_bit_for_bit(tmp_path, name, dtype, numpy_type):
    rng = np.random.default_rng(0)
    truth = rng.normal(size=(33, 21)).astype(numpy_type)
    with np.errstate(over="ignore"):
        truth[0, : len(SPECIAL)] = np.array(SPECIAL).astype(numpy_type)
    write_picture(tmp_path / name, truth, dtype=dtype)
    read = read_band(tmp_path / name)
    bits = f"u{truth.itemsize}"
    assert read.dtype == (np.float64 if dtype == "double" else np.float32)
    assert np.array_equal(read.astype(numpy_type).view(bits), truth.view(bits))
    assert list(tmp_path.iterdir()) == [tmp_path / name]


def test_whole_numbers_are_made_block_by_block():
    """Of 1003 rows of 100 doubles, 0.8 MB, the copies that scaling takes are those of 256."""
    samples = np.random.default_rng(0).normal(size=(1003, 100, 1))
    tracemalloc.start()
    try:
        stored = as_stored(samples, "uint16", -1.0, 1.0)
        most = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert most < stored.nbytes + 4 * 8 * 256 * 100
    np.testing.assert_array_equal(stored, np.rint((samples.clip(-1, 1) + 1) / 2 * 65535))
    samples[700, 3] = np.nan
    with pytest.raises(DataError, match="sample at row 700, column 3 is not finite"):
        as_stored(samples, "uint16", -1.0, 1.0)


@pytest.mark.parametrize("name", ["a.tif", "a.exr"])
def test_channels_are_bands(tmp_path, name):
    truth = np.random.default_rng(0).random((4, 6, 4), dtype=np.float32)
    write_picture(tmp_path / name, truth)
    assert read_info(tmp_path / name).bands == 4
    for band in range(4):
        assert np.array_equal(read_pixels(tmp_path / name, band), truth[:, :, band])
    for band in (-1, 4):
        with pytest.raises(FileError, match=f"no band {band}; allowed: 0 to 3"):
            read_pixels(tmp_path / name, band)


@pytest.mark.parametrize(("dtype", "top"), [("uint8", 255), ("uint16", 65535)])
def test_display_scaling(tmp_path, dtype, top):
    values = np.array([[-1e300, 9.9, 10, 15, 20, 20.1, 1e300]])
    write_picture(tmp_path / "a.png", values, dtype=dtype, low=10, high=20)
    middle = round(top / 2)
    assert read_band(tmp_path / "a.png").tolist() == [[0, 0, 0, middle, top, top, top]]


@pytest.mark.parametrize("name", ["a.tif", "a.exr", "a.png"])
def test_metadata_is_found_again(tmp_path, name):
    metadata = {"unit": "W/m^2/sr", "fov_x_deg": 23.8, "fov_y_deg": 17.9, "focal_length_mm": 38}
    dtype = "uint8" if name == "a.png" else "float"
    write_picture(tmp_path / name, np.ones((2, 3)), dtype=dtype, metadata=metadata)
    info = read_info(tmp_path / name)
    assert (info.unit, info.fov_x_deg, info.fov_y_deg) == ("W/m^2/sr", 23.8, 17.9)
    assert info.focal_length_mm == 38


@pytest.mark.parametrize(
    ("name", "array", "options", "error", "message"),
    [
        ("a.xyz", [[1.0]], {}, FileError, "unknown picture suffix '.xyz'; allowed: .exr, .tif"),
        ("a", [[1.0]], {}, FileError, "unknown picture suffix ''"),
        ("a.png", [[1.0]], {}, ParameterError, "dtype = 'float' is not allowed: a .png file holds"),
        ("a.exr", [[1.0]], {"dtype": "double"}, ParameterError, "a .exr file holds float, half"),
        ("a.tif", [1.0], {}, DataError, "shape .1,. cannot"),
        ("a.tif", np.zeros((0, 3)), {}, DataError, "not empty"),
        ("a.tif", [[1j]], {}, DataError, "must be real"),
        ("a.tif", [[0, 1e39]], {}, DataError, "beyond .* the first at row 0, column 1"),
        ("a.exr", [[0, 7e4]], {"dtype": "half"}, DataError, "beyond ±65504"),
        (
            "a.png",
            [[0, 0.5]],
            {"dtype": "uint8"},
            DataError,
            "0.5 at row 0, column 1 does not fit uint8",
        ),
        ("a.png", [[0, 256]], {"dtype": "uint8"}, DataError, "give low and high to scale"),
        ("a.png", [[np.nan]], {"dtype": "uint8"}, DataError, "not finite"),
        ("a.png", [[1]], {"dtype": "uint8", "low": 1, "high": 1}, ParameterError, "above low = 1"),
        ("a.png", [[1]], {"dtype": "uint8", "low": 1}, ParameterError, "two finite numbers"),
        ("a.tif", [[1]], {"low": 0, "high": 1}, ParameterError, "empty with dtype float"),
        ("no/a.tif", [[1]], {}, FileError, "there is no folder"),
    ],
)
def test_what_cannot_be_written(tmp_path, name, array, options, error, message):
    with pytest.raises(error, match=message):
        write_picture(tmp_path / name, array, **options)
    assert not list(tmp_path.iterdir())


FULL_DISK = """
import resource, sys
from pathlib import Path
import numpy as np
from core.errors import FileError
from nodes.files.pictures import read_band
from nodes.files.formats import write_picture
folder = Path(sys.argv[1])
samples = np.random.default_rng(0).integers(0, 65536, (60, 60))
free = resource.RLIM_INFINITY
for name, dtype in (("a.tif", "float"), ("a.exr", "float"), ("a.png", "uint16")):
    write_picture(folder / name, samples // 2, dtype=dtype)
    size = (folder / name).stat().st_size
    write_picture(folder / name, samples, dtype=dtype)
    for limit in (0, 10, 500, size // 2, size * 9 // 10, size - 40, size - 1):
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, free))
        try:
            write_picture(folder / name, samples // 2, dtype=dtype)
            print("not noticed", name, limit, size)
        except FileError as error:
            if not error.message.startswith(f"cannot write {folder / name}: "):
                print(error.message)
        resource.setrlimit(resource.RLIMIT_FSIZE, (free, free))
        if not np.array_equal(read_band(folder / name), samples):
            print("lost", name, limit, size)
print(sorted(entry.name for entry in folder.iterdir()))
"""


def test_full_disk_is_noticed_at_every_place_and_keeps_the_old_picture(tmp_path):
    done = run_program(FULL_DISK, str(tmp_path))
    assert done.stdout == "['a.exr', 'a.png', 'a.tif']\n"
    assert done.stderr == ""


WRITE_FOR_EVER = """
import itertools, sys
import numpy as np
from nodes.files.formats import write_picture
for count in itertools.count(1):
    write_picture(sys.argv[1], np.full((600, 700), count, dtype=np.float32))
    if count == 1:
        print("first", flush=True)
"""


@pytest.mark.parametrize("name", ["a.tif", "a.exr"])
def test_killed_at_any_time_the_picture_is_whole(tmp_path, name):
    path = tmp_path / name
    for delay_s in (0.0, 0.013, 0.031, 0.05):
        kill_program(WRITE_FOR_EVER, str(path), says="first", after_s=delay_s)
        read = read_band(path)
        assert read.shape == (600, 700)
        assert np.all(read == read[0, 0])
