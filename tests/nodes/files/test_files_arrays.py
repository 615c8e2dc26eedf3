"""Arrays, matrices and curves in files."""

import csv
import os
from typing import NamedTuple

import numpy as np
import pytest

from app.run.saving import save_value
from core.chain.engine import Engine
from core.chain.wires import Curve, CurveData, Series
from core.errors import DataError, FileError
from core.evaluation.recipes import Step
from core.evaluation.work import Policy
from core.machine import usable_bytes
from core.modules.declaration import Module, NodeContext
from linked_network import linked_network
from nodes.files import arrays
from nodes.files.formats import read_info, read_pixels
from nodes.input_output.write_image import WriteMatrix


@pytest.mark.parametrize(
    ("dtype", "wanted"),
    [
        ("f2", "f4"),
        ("<f4", "f4"),
        (">f4", "f4"),
        (">f8", "f8"),
        ("u1", "f4"),
        ("?", "f4"),
        (">i2", "f4"),
        ("u2", "f4"),
        ("i4", "f8"),
        ("u8", "f8"),
    ],
)
@pytest.mark.parametrize("order", ["C", "F"])
def test_npy_of_every_real_type(tmp_path, dtype, wanted, order):
    truth = np.arange(12).reshape(3, 4).astype(dtype)
    np.save(tmp_path / "a.npy", np.asarray(truth, order=order))
    read = read_pixels(tmp_path / "a.npy")
    assert read.dtype == np.dtype(wanted)
    assert read.dtype.isnative
    assert read.flags.c_contiguous
    assert type(read) is np.ndarray
    assert np.array_equal(read, truth.astype(wanted))
    info = read_info(tmp_path / "a.npy")
    assert (info.rows, info.columns, info.bands, info.kind) == (3, 4, 1, "npy")


def test_npy_band(tmp_path):
    truth = np.random.default_rng(0).random((3, 4, 2))
    np.save(tmp_path / "a.npy", truth)
    assert np.array_equal(read_pixels(tmp_path / "a.npy", 1), truth[:, :, 1])
    with pytest.raises(FileError, match="no band 2; allowed: 0 to 1"):
        read_pixels(tmp_path / "a.npy", 2)


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.array([[{}, 1]], dtype=object), "contains Python objects"),
        (np.ones((2, 2), dtype=complex), "samples of type complex128"),
        (np.array([["a"]]), "samples of type <U1"),
        (np.zeros((2, 2), dtype=[("x", "f4")]), "samples of type"),
        (np.zeros((2, 2), dtype="M8[s]"), "samples of type datetime64"),
        (np.zeros(5), r"array of shape \(5,\); allowed: \(rows, columns\)"),
        (np.zeros((2, 0)), r"array of shape \(2, 0\)"),
        (np.zeros((1, 1, 1, 1)), "array of shape"),
        (np.float64(3), r"array of shape \(\)"),
    ],
)
def test_npy_that_is_no_picture(tmp_path, array, message):
    np.save(tmp_path / "a.npy", array, allow_pickle=True)
    for read in (read_info, read_pixels):
        with pytest.raises(FileError, match=message):
            read(tmp_path / "a.npy")


def test_damaged_npy(tmp_path):
    path = tmp_path / "a.npy"
    np.save(path, np.zeros((30, 40)))
    whole = path.read_bytes()
    for length in (len(whole) - 1, 130, 100, 20, 9, 7, 3):
        path.write_bytes(whole[:length])
        with pytest.raises(FileError, match=r"truncated|not a \.npy"):
            read_pixels(path)
    path.write_bytes(whole.replace(b"'descr': '<f8'", b"'descr': [[[[[["))
    with pytest.raises(FileError, match="damaged"):
        read_pixels(path)
    huge = b"(%d, %d), }" % (2**33, 2**33)
    path.write_bytes(whole.replace(b"(30, 40), }".ljust(len(huge)), huge))
    assert path.stat().st_size == len(whole)
    with np.errstate(all="raise"), pytest.raises(FileError, match="damaged"):  # as in a run
        read_pixels(path)
    path.write_bytes(b"pickle" * 50)
    with pytest.raises(FileError, match=r"not a \.npy file"):
        read_pixels(path)


@pytest.mark.parametrize("suffix", [".txt", ".csv", ".prn"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_text_matrix_reads_back_bit_for_bit(tmp_path, suffix, dtype):
    values = [[0.1, 1 / 3, -0.0], [3e38, 1e-38, 16777217]]
    truth = np.array(values, dtype=dtype)
    path = tmp_path / f"m{suffix}"
    arrays.write_matrix(path, truth)
    assert np.array_equal(read_pixels(path).astype(dtype).tobytes(), truth.tobytes())
    assert (read_info(path).rows, read_info(path).columns) == (2, 3)
    # An independent reading, number by number.
    separator = "," if suffix == ".csv" else None
    lines = path.read_text().splitlines()
    assert [[dtype(word) for word in line.split(separator)] for line in lines] == truth.tolist()


def test_text_matrix_written_by_others(tmp_path):
    path = tmp_path / "m.txt"
    path.write_text("# comment\n  1\t2  3\r\n\n 4 5e0 -6.\n")
    assert np.array_equal(arrays.read_matrix(path), [[1, 2, 3], [4, 5, -6]])
    path.write_text("7")
    assert np.array_equal(arrays.read_matrix(path), [[7]])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"1 2\n3\n", "line 2: must contain 2 numbers, as in the first row, not 1"),
        (b"1 2\n3 x\n", "not a matrix of numbers; line 2 contains text"),
        (b"1;2\n", "not a matrix of numbers; line 1 contains text"),
        (b"\n# nothing\n", "contains no numbers"),
        (b"\xff\xfe\x00", "not a text file with numbers"),
    ],
)
def test_text_that_is_no_matrix(tmp_path, content, message):
    (tmp_path / "m.txt").write_bytes(content)
    with pytest.raises(FileError, match=message):
        read_pixels(tmp_path / "m.txt")


@pytest.mark.parametrize("length", [usable_bytes(), (1 << 29) + 1])
def test_a_text_that_is_too_long_is_refused_before_it_is_read(tmp_path, length):
    path = tmp_path / "a.csv"
    with path.open("wb") as file:
        file.write(b"1,2\n")
        file.truncate(length)  # without blocks on the disk
    for read in (read_info, read_pixels):
        with pytest.raises(
            FileError, match=r"a text file of .* GB is too large; the limit is 0\.\d+ GB"
        ):
            read(path)


def test_what_cannot_be_written_leaves_no_file(tmp_path):
    path = tmp_path / "m.txt"
    with pytest.raises(
        DataError, match=r"the matrix has 1 non-finite sample, the first at \(0, 1\)"
    ):
        arrays.write_matrix(path, [[0, np.nan]])
    with pytest.raises(DataError, match="is not a matrix"):
        arrays.write_matrix(path, np.zeros((2, 2, 2)))
    with pytest.raises(DataError, match="allowed: real numbers"):
        arrays.write_npy(path, np.ones(2, dtype=complex))
    assert not list(tmp_path.iterdir())


def test_paths_that_cannot_be_read(tmp_path):
    (tmp_path / "empty.img").touch()
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "x.foo").write_bytes(b"some text" * 30)
    (tmp_path / "x.img").write_bytes(b"some text" * 30)
    (tmp_path / "x.null").write_bytes(b"some text" * 30)
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    cases = {
        "": "path is empty",
        "a\0b": "null character",
        tmp_path / "none.tif": "no such file",
        tmp_path / "x.foo" / "a": "Not a directory",
        tmp_path: "a folder, not a file",
        tmp_path / "pipe": "not a regular file",
        tmp_path / "empty.img": "the file is empty",
        tmp_path / "x.foo": r"x\.foo: cannot be opened: .*format",
        tmp_path / "x.null": r"unknown format \.null",
        tmp_path / "x.img": "ENVI header is missing",
        tmp_path / "loop": "symbolic links",
        tmp_path / ("n" * 300): "name too long",
    }
    for path, message in cases.items():
        for read in (read_info, read_pixels):
            with pytest.raises(FileError, match=message) as caught:
                read(path)
            assert "\n" not in caught.value.message


NAMES = ("optics, cold", 'detector "A"', "jitter")
BARS = CurveData(
    "Shares",
    "stage",
    "NETD (mK)",
    (
        Series("temporal", np.arange(3.0), np.array([0.1, 20.5, np.inf])),
        Series("fixed", np.arange(3.0), np.array([-1.0, 0.0, 1 / 3])),
    ),
    bars=NAMES,
)
FINITE = CurveData("", "stage", "mK", (Series("a", np.arange(3.0), np.arange(3.0) / 7),), NAMES)
MRTD = CurveData(
    "MRTD",
    "frequency (cyc/mrad)",
    "MRTD (K)",
    (Series("MRTD", np.array([0.5, 1.0]), np.array([0.2, np.inf])),),
    log_y=True,
)


class DrawnOutputs(NamedTuple):
    curve: Curve


def made(_work, *, which):
    return {"bars": BARS, "finite": FINITE, "mrtd": MRTD}[which]


class Drawn(Module, key="drawn", title="Drawn", group="Analysis"):
    """Make a curve."""

    def run(self, here: NodeContext) -> DrawnOutputs:
        """One of three, by the node's name."""
        return DrawnOutputs(Curve(Step.of(made, which=here.node)))


ENGINE = Engine({module.key: module for module in (Drawn, WriteMatrix)})


def rows_of(path):
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.reader(file))


def written(folder, which, name):
    """By the module that writes, and by the command line's `--save`."""
    network = linked_network(
        {which: ("drawn", {}), "out": ("write_matrix", {"path": name})},
        [(f"{which}.curve", "out.image")],
    )
    plan = ENGINE.plan(network, folder=folder)
    work = ENGINE.work(Policy())
    planned = plan.nodes["out"]
    here = NodeContext("out", network.seed, folder)
    for target, write in planned.module.files(planned.inputs, here, work):
        write(target)
    return folder / name, plan, work


@pytest.mark.parametrize("by", ["module", "command line"])
def test_bars_are_written_with_their_names(tmp_path, by):
    path, plan, work = written(tmp_path, "bars", "b.csv")
    if by == "command line":
        path = tmp_path / "saved.csv"
        save_value(plan.output("bars.curve"), path, work, port="bars.curve")
    assert rows_of(path) == [
        ["stage", "temporal", "fixed"],
        [NAMES[0], "0.1", "-1.0"],
        [NAMES[1], "20.5", "0.0"],
        [NAMES[2], "inf", "0.3333333333333333"],
    ]


def test_an_infinite_value_is_written_as_csv(tmp_path):
    path, plan, work = written(tmp_path, "mrtd", "m.csv")
    wanted = [["frequency (cyc/mrad)", "MRTD"], ["0.5", "0.2"], ["1.0", "inf"]]
    assert rows_of(path) == wanted
    save_value(plan.output("mrtd.curve"), tmp_path / "s.csv", work, port="mrtd.curve")
    assert rows_of(tmp_path / "s.csv") == wanted
