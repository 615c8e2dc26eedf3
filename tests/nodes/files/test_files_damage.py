"""Pictures that a bit, a claim or a lost end has made another: refused, never read as whole."""

import re
import struct
import sys
import tracemalloc
import zlib
from pathlib import Path

import numpy as np
import pytest

from child_process import run_program
from core.errors import FileError
from core.machine import usable_bytes
from nodes.files.formats import read_info, read_pixels, write_picture
from nodes.files.picture_info import PictureInfo, refuse_oversized
from picture_samples import png, tiff, tiff_tag

TRUTH = np.add.outer(np.arange(48.0), np.sin(np.arange(40.0))).astype(np.float32)


@pytest.mark.parametrize("layout", [{"strip_rows": 5}, {"tile": 16}])
def test_a_packing_that_cannot_be_read_is_no_damage(tmp_path, layout):
    """Zstandard, which not every build of the library unpacks."""
    content, _ = tiff(TRUTH, packed=True, **layout)
    zstd = content.replace(tiff_tag(259, 8), tiff_tag(259, 50000))
    assert zstd != content
    (tmp_path / "a.tif").write_bytes(zstd)
    with pytest.raises(FileError) as refusal:
        read_pixels(tmp_path / "a.tif", 0)
    if "not configured" in str(refusal.value):
        assert "damaged" not in str(refusal.value)
        assert "deflate" in str(refusal.value)


LAYOUTS = [
    {"strip_rows": 48},
    {"strip_rows": 5},
    {"strip_rows": 7, "order": ">"},
    {"tile": 16},
    {"tile": 32, "big": True},
    {"strip_rows": 16, "big": True, "order": ">"},
]


@pytest.mark.parametrize("layout", LAYOUTS)
def test_no_flipped_bit_of_a_deflate_tiff_gives_other_samples(tmp_path, layout):
    whole, blocks = tiff(TRUTH, packed=True, **layout)
    path = tmp_path / "a.tif"
    path.write_bytes(whole)
    assert np.array_equal(read_pixels(path), TRUTH)
    refused = 0
    for place, size in blocks:
        for byte in range(place, place + size, max(1, sum(s for _, s in blocks) // 200)):
            damaged = bytearray(whole)
            damaged[byte] ^= 1 << (byte % 8)
            path.write_bytes(damaged)
            try:
                # Bits that fill the last byte before the checksum are no part of the samples.
                assert np.array_equal(read_pixels(path), TRUTH)
            except FileError:
                refused += 1
    assert refused > 190


def test_a_block_of_fewer_rows_or_none_is_refused(tmp_path):
    path = tmp_path / "a.tif"
    whole, blocks = tiff(TRUTH, packed=True, strip_rows=12)
    place, size = blocks[1]
    claim = whole.replace(tiff_tag(277, 1), tiff_tag(285, 1))
    path.write_bytes(claim.replace(tiff_tag(258, 32), tiff_tag(258, 8)))
    with pytest.raises(FileError, match="strip or tile 0 holds 1920 bytes instead of 480"):
        read_pixels(path)
    short = zlib.compress(TRUTH[12:20].tobytes())
    assert len(short) < size
    path.write_bytes(whole[:place] + short.ljust(size, b"\0") + whole[place + size :])
    with pytest.raises(FileError, match="strip or tile 1 holds 1280 bytes instead of 1920"):
        read_pixels(path)
    path.write_bytes(whole.replace(struct.pack("<I", size), struct.pack("<I", 10**9), 1))
    with pytest.raises(FileError, match="beyond the end of the file"):
        read_pixels(path)
    path.write_bytes(whole[:place] + bytes(size) + whole[place + size :])
    with pytest.raises(FileError, match="damaged: strip or tile 1"):
        read_pixels(path)


def with_predictor(path, samples, compression, predictor):
    """A little-endian TIFF of one strip; PackBits in literal runs of up to 128 bytes."""
    raw = samples.tobytes()
    if compression == 32773:
        runs = [raw[start : start + 128] for start in range(0, len(raw), 128)]
        raw = b"".join(bytes([len(run) - 1]) + run for run in runs)
    rows, columns = samples.shape
    fields = [(256, columns), (257, rows), (258, 8 * samples.itemsize), (259, compression)]
    fields += [(262, 1), (273, 8), (277, 1), (278, rows), (279, len(raw)), (317, predictor)]
    entries = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in fields)
    head = b"II*\0" + struct.pack("<I", 8 + len(raw))
    path.write_bytes(head + raw + struct.pack("<H", len(fields)) + entries + bytes(4))


@pytest.mark.parametrize(("compression", "name"), [(32773, "PackBits"), (1, "no compression")])
@pytest.mark.parametrize("dtype", ["u1", "<u2"])
def test_a_tiff_predictor_that_programs_differ_on(tmp_path, compression, name, dtype):
    truth = np.add.outer(np.arange(8), np.arange(30)).astype(dtype)
    path = tmp_path / "a.tif"
    with_predictor(path, truth, compression, 1)
    assert np.array_equal(read_pixels(path), truth)
    with_predictor(path, np.diff(truth, axis=1, prepend=truth[:, :1] * 0), compression, 2)
    for read in (read_info, read_pixels):
        with pytest.raises(FileError, match=f"predictor 2 with {name} cannot be read, .*; allowed"):
            read(path)


def refused_for_its_size(path, rows, columns, reads=(read_info, read_pixels)):
    tracemalloc.start()
    for read in reads:
        with pytest.raises(FileError) as caught:
            read(path)
        words = rf"{rows} × {columns} samples need .* GB; the limit on this machine is .* GB"
        assert re.search(words, str(caught.value))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    return peak < 10_000_000


def test_a_huge_array_is_refused_before_memory_is_asked_for(tmp_path):
    rows, columns = usable_bytes() // 7000, 1000  # as floats more than half of the memory
    with (tmp_path / "a.npy").open("wb") as file:
        shape = {"descr": "|u1", "fortran_order": False, "shape": (rows, columns)}
        np.lib.format.write_array_header_1_0(file, shape)
        file.truncate(file.tell() + rows * columns)  # a hole: nothing is written
    assert read_info(tmp_path / "a.npy").rows == rows  # which a run may make in blocks
    assert refused_for_its_size(tmp_path / "a.npy", rows, columns, (read_pixels,))


def test_a_one_bit_png_takes_the_memory_of_its_samples(tmp_path):
    """Peak of a process of its own: 4 bytes a sample, and strips."""
    rows, columns = 5000, 5000
    body = zlib.compress((b"\0" + b"\x55" * (columns // 8)) * rows)
    (tmp_path / "a.png").write_bytes(png(rows, columns, 1, body))
    program = (
        "import resource, sys; from nodes.files.formats import read_info, read_pixels\n"
        "read_info(sys.argv[1])\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "samples = read_pixels(sys.argv[1])\n"
        "assert samples[0, :4].tolist() == [0, 1, 0, 1] and samples[-1, -1] == 1\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)"
    )
    done = run_program(program, str(tmp_path / "a.png"))
    unit = 1 if sys.platform == "darwin" else 1024
    assert int(done.stdout) * unit < 4 * rows * columns + 250e6


def test_a_header_that_claims_more_than_the_file_can_hold_is_damaged(tmp_path):
    (tmp_path / "a.png").write_bytes(png(20000, 20000, 8, zlib.compress(bytes(1000))))
    with pytest.raises(FileError, match=r"20000 × 20000 × 1 samples of 8 bits do not fit in"):
        read_info(tmp_path / "a.png")
    whole, _ = tiff(TRUTH, packed=True, strip_rows=48)
    claim = whole.replace(tiff_tag(257, 48), tiff_tag(257, 9**6))
    (tmp_path / "a.tif").write_bytes(claim)
    with pytest.raises(FileError, match="do not fit in a file of"):
        read_info(tmp_path / "a.tif")
    write_picture(tmp_path / "a.exr", TRUTH)  # whose header tells the bits by a type
    whole, window = (tmp_path / "a.exr").read_bytes(), struct.pack("<4i", 0, 0, 39, 47)
    assert whole.count(window) == 2
    (tmp_path / "a.exr").write_bytes(whole.replace(window, struct.pack("<4i", 0, 0, 39, 9**6)))
    with pytest.raises(FileError, match="40 × 1 samples of 32 bits do not fit in a file of"):
        read_info(tmp_path / "a.exr")


def test_the_budget_is_of_the_memory_that_a_container_leaves(monkeypatch):
    shape = {"rows": 1000, "columns": 500, "bands": 1, "dtype": "float32", "kind": "tiff"}
    info = PictureInfo(path=Path("a.tif"), **shape)
    refuse_oversized(info)
    monkeypatch.setattr("core.machine._limits", lambda: [3_999_999])
    with pytest.raises(FileError, match="the limit on this machine is "):
        refuse_oversized(info)
