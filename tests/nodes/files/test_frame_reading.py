"""Frames read one after the other, from files that numpy and Pillow have written."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest
from PIL import Image as Pillow

from child_process import PEAK, ROOT
from core.errors import FileError
from nodes.files.frames import open_frames
from picture_samples import envi

FRAMES = np.random.default_rng(3).integers(0, 60000, (6, 9, 13)).astype(np.uint16)


def pages(path, frames, **how):
    first, *others = (Pillow.fromarray(frame) for frame in frames)
    first.save(path, save_all=True, append_images=others, **how)
    return path


def bands(path, frames, interleave="bsq"):
    return envi(path, frames.transpose(1, 2, 0), interleave, data_units="DN")


def npy(path, frames):
    np.save(path, frames)
    return path


def check(path, frames=FRAMES):
    found = open_frames(path)
    assert (found.frames, found.rows, found.columns) == frames.shape
    read = list(found.each())
    assert len(read) == len(frames)
    for one, frame in zip(read, frames, strict=True):
        np.testing.assert_array_equal(one, frame)
    return found


@pytest.mark.parametrize("how", [{}, {"compression": "tiff_adobe_deflate"}, {"big_tiff": True}])
def test_pages_of_a_tiff(tmp_path, how):
    assert check(pages(tmp_path / "f.tif", FRAMES, **how)).dtype == np.uint16


@pytest.mark.parametrize("kind", [np.uint8, np.float32])
def test_other_samples(tmp_path, kind):
    frames = (FRAMES / 300).astype(kind)
    check(pages(tmp_path / "f.tif", frames), frames)
    check(npy(tmp_path / "f.npy", frames), frames)


@pytest.mark.parametrize("interleave", ["bsq", "bil", "bip"])
def test_bands_of_an_envi_file(tmp_path, interleave):
    path = bands(tmp_path / "f.bsq", FRAMES, interleave)
    assert check(path).unit == "DN"
    check(path.with_name("f.bsq.hdr"))


def refusal(path):
    with pytest.raises(FileError) as raised:
        open_frames(path)
    assert "\n" not in str(raised.value)
    return str(raised.value).removeprefix(f"{path}: ")


def test_what_is_refused(tmp_path):
    assert refusal(pages(tmp_path / "a.tif", [FRAMES[0], FRAMES[1], FRAMES[2, :4]])) == (
        "the frames differ: page 3 has 4 × 13 samples of uint16, but the first page has 9 × 13 "
        "samples of uint16; allowed: frames of the same size and type"
    )
    assert "page 2 has 9 × 13 samples of float32, but the first page" in refusal(
        pages(tmp_path / "b.tif", [FRAMES[0], FRAMES[1].astype(np.float32)])
    )
    colour = np.zeros((4, 5, 3), np.uint8)
    assert refusal(pages(tmp_path / "c.tif", [colour, colour])) == (
        "page 1 has channels = 3, compression = 1; allowed: one channel of plain numbers, "
        "uncompressed or deflate"
    )
    assert "page 1 has channels = 1, compression = 5" in refusal(
        pages(tmp_path / "d.tif", FRAMES, compression="tiff_lzw")
    )
    assert refusal(npy(tmp_path / "e.npy", np.zeros(5))) == (
        "contains an array of shape (5,); allowed: (frames, rows, columns), all above 0"
    )
    assert "contains samples of type complex128" in refusal(
        npy(tmp_path / "f.npy", np.zeros((2, 3, 4), complex))
    )
    Pillow.fromarray(colour).save(tmp_path / "g.png")
    assert refusal(tmp_path / "g.png") == (
        "frames cannot be read from this file; allowed: .npy (frames, rows, columns), TIFF with "
        "one page per frame, ENVI with one band per frame"
    )
    cut = pages(tmp_path / "h.tif", FRAMES)
    cut.write_bytes(cut.read_bytes()[:-300])
    assert "damaged" in refusal(cut)


def test_directories_in_a_circle(tmp_path):
    path = pages(tmp_path / "f.tif", FRAMES[:2])
    content = bytearray(path.read_bytes())
    first = int.from_bytes(content[4:8], "little")
    count = int.from_bytes(content[first : first + 2], "little")
    after = first + 2 + 12 * count
    content[after : after + 4] = first.to_bytes(4, "little")
    path.write_bytes(content)
    assert refusal(path).endswith("the directories form a loop")


@pytest.mark.parametrize("name", ["f.npy", "f.tif", "f.bsq"])
def test_many_frames_take_the_memory_of_a_few(tmp_path, name):
    """Of 20 frames or of 600, 48 MB in all, in a process of their own."""
    code = (
        "import sys\nfrom pathlib import Path\n"
        "from nodes.files.frames import open_frames\n"
        "print(sum(float(f.sum()) for f in open_frames(Path(sys.argv[1])).each()))\n"
        f"{PEAK}"
    )
    peaks = []
    for count in (20, 600):
        frames = np.full((count, 200, 200), 7, np.uint16)
        made = {"f.npy": npy, "f.tif": pages, "f.bsq": bands}[name](tmp_path / name, frames)
        done = subprocess.run(
            [sys.executable, "-c", code, str(made)],
            cwd=ROOT, capture_output=True, text=True, check=True, timeout=300,
        )  # fmt: skip
        total, peak = done.stdout.split()
        assert float(total) == frames.sum()
        peaks.append(int(peak) / 1024)
    assert peaks[1] < peaks[0] + 8.0
