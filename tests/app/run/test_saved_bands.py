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


def test_a_region_of_them(works, banded, tmp_path):
    works("run", banded, "--save", "scene.image=b.bsq", "--save", "scene.image[2:9,5:]=part.bsq")
    for index in range(6):
        whole, part = (read_pixels(tmp_path / name, index) for name in ("b.bsq", "part.bsq"))
        assert np.array_equal(part, whole[2:9, 5:])


def test_a_picture_without_bands_is_one_band(imagechain, small, write, tmp_path):
    saves = ("--save", "scene.image=b.img", "--save", "scene.image=b.npy")
    assert imagechain("run", write(small), *saves).returncode == 0
    whole = np.load(tmp_path / "b.npy")
    assert np.array_equal(np.fromfile(tmp_path / "b.img", "<f4").reshape(whole.shape), whole)
    assert "bands = 1\n" in (tmp_path / "b.img.hdr").read_text()
