"""Which transforms are in use: installed ones of Intel, else those of scipy."""

from importlib.util import find_spec

import numpy as np
import pytest
import scipy.fft

from core.transfer import periodic as fourier

HAS_INTEL = find_spec("mkl_fft") is not None and find_spec("mkl") is not None


def test_what_is_installed_is_chosen_and_told():
    assert fourier.backend() == ("mkl_fft" if HAS_INTEL else "scipy.fft")


@pytest.mark.parametrize("shape", [(1, 2), (8, 9), (31, 16)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_transforms_are_those_of_the_definition(shape, dtype):
    image = np.random.default_rng(3).normal(size=shape).astype(dtype)
    down, across = (
        np.exp(-2j * np.pi * (np.outer(np.arange(n), np.arange(n)) % n) / n) for n in shape
    )
    expected = (down @ image.astype(float) @ across)[:, : shape[1] // 2 + 1]
    found = fourier.fourier().rfft2(image, workers=1)
    rounding = 20 * np.finfo(dtype).eps * np.abs(expected).max()
    assert found.real.dtype == dtype
    assert np.abs(found - expected).max() < rounding
    back = fourier.fourier().irfft2(found, s=shape, workers=1)
    assert np.abs(back - image).max() < rounding


def test_an_installation_that_does_not_load_is_done_without(monkeypatch):
    def refuse(name):
        raise OSError("libmkl_rt.so.2: cannot open shared object file")

    monkeypatch.setattr(fourier, "import_module", refuse)
    fourier.fourier.cache_clear()
    try:
        assert fourier.fourier() is scipy.fft
    finally:
        fourier.fourier.cache_clear()
