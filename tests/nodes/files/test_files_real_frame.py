import os
from pathlib import Path

import numpy as np

from nodes.files.read import read_info, read_pixels

REAL_FRAME = Path(__file__).parents[3] / "../shared/data/sc660_lwir.img"


def test_real_frame():
    if not REAL_FRAME.exists():
        print(f"the real frame is not compared: there is no {os.fspath(REAL_FRAME)}")
        return
    info = read_info(REAL_FRAME)
    assert (info.rows, info.columns, info.bands, info.dtype) == (480, 640, 1, "float64")
    assert (info.unit, info.wavelengths_um, info.fwhm_um) == ("W/m^2/sr", (10.25,), (5.5,))
    frame = read_pixels(REAL_FRAME)
    assert frame.dtype == np.float64
    assert np.array_equal(frame, np.fromfile(REAL_FRAME, "<f8").reshape(480, 640))
    assert round(float(np.median(frame)), 2) == 52.87
    tiff = read_pixels(REAL_FRAME.with_suffix(".tif"))
    assert tiff.dtype == np.float32
    assert np.array_equal(tiff, frame.astype(np.float32))
