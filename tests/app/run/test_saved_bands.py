"""``--save NODE.PORT=FILE.img``: all bands of a picture."""

import numpy as np
import pytest

from nodes.files.read import read_info, read_pixels


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
