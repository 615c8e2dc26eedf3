"""Sums over the bands of a cube whose file is damaged, changed meanwhile, or very long in bands."""

import sys
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from child_process import finished
from nodes.files.envi import band_weights_um
from nodes.files.picture_info import PictureInfo
from picture_samples import envi

INTERLEAVES = ("bsq", "bil", "bip")
CUT_SHORT = """
import os, sys
import numpy as np
from nodes.files.envi import weighted_sums
from nodes.files.envi_header import read_layout

layout = read_layout(sys.argv[1])
def cut_short(function, items):
    os.truncate(layout.data, 100)
    for item in items:
        function(item)
weighted_sums(layout, np.ones((1, layout.bands)), dtype=np.dtype("f4"), for_each=cut_short)
"""


@pytest.mark.parametrize("interleave", INTERLEAVES)
def test_a_file_cut_short_while_it_is_read_is_an_error_and_no_end_of_the_process(
    tmp_path, interleave
):
    data = envi(tmp_path / "x.img", np.ones((64, 64, 5), "f4"), interleave)
    ended = finished([sys.executable, "-c", CUT_SHORT, str(data)])
    assert ended.returncode == 1
    assert f"FileError: {data}: ends before its last sample" in ended.stderr


def info(centres, widths):
    given = {"wavelengths_um": tuple(centres), "fwhm_um": tuple(widths), "dtype": "float32"}
    return PictureInfo(Path("x.img"), 1, 1, len(centres), kind="envi", **given)


def test_the_widths_of_65536_bands_take_no_table_of_bands_by_bands():
    count = 65536
    described = info(3.0 + (np.arange(count) + 0.5) * 2.0**-15, [2.0**-15] * count)
    tracemalloc.start()
    widths = band_weights_um(described, cut_on_um=3.25, cut_off_um=5.5)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    want = np.where(np.arange(count) < 0.25 * 2**15, 0.0, 2.0**-15)  # to 5 µm, side by side
    np.testing.assert_array_equal(widths, want)
    assert peak < 100 * count * 8


def test_overlapping_bands_in_any_order_share_what_they_cover():
    # 3-5, 4-6, 4-5 and 7-8 µm: 3-4 of one, 4-5 of three, 5-6 of one, a gap, 7-8 of one.
    described = info([5.0, 7.5, 4.0, 4.5], [2.0, 1.0, 2.0, 1.0])
    widths = band_weights_um(described, cut_on_um=0.0, cut_off_um=100.0)
    np.testing.assert_allclose(widths, [4 / 3, 1.0, 4 / 3, 1 / 3], rtol=1e-15)
    cut = band_weights_um(described, cut_on_um=4.5, cut_off_um=5.5)
    np.testing.assert_allclose(cut, [1 / 6 + 0.5, 0.0, 1 / 6, 1 / 6], rtol=1e-15)
