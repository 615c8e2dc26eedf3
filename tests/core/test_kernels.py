"""Transforms and special functions equal those of SciPy's public modules, bit by bit."""

import os
import sys

import numpy as np
import pytest
import scipy

from child_process import ROOT, finished
from core import kernels

REAL = ("rfft", "dct", "idct", "dst", "idst", "fft", "ifft")
PLANAR = ("rfft2", "fft2", "dctn")


def same(name, samples, **how):
    public = getattr(scipy.fft, name)(samples.copy(), **how)
    own = getattr(kernels, name)(samples.copy(), **how)
    assert (own.dtype, own.shape, own.tobytes()) == (public.dtype, public.shape, public.tobytes())


@pytest.mark.parametrize("kernel", [True, False], ids=["compiled", "public"])
@pytest.mark.parametrize("dtype", ["f4", "f8", ">f8", "i4", "f2"])
def test_transforms_equal_those_of_scipy(dtype, kernel, monkeypatch):
    if not kernel:
        monkeypatch.setattr(kernels, "_compiled", lambda *_: None)
    picture = (100 * np.random.default_rng(5).normal(size=(12, 15))).astype(dtype)
    for norm in (None, "ortho", "forward"):
        for axis, size in ((0, 12), (1, 15), (-1, 8)):
            how = {"axis": axis, "norm": norm, "workers": 2, "overwrite_x": True}
            for name in REAL:
                same(name, picture, **how)
            waves = scipy.fft.rfft(picture, axis=axis)
            for samples in (waves, waves.real):
                same("irfft", samples, n=size, **how)
                same("ifft", samples, **how)
                same("irfft", samples, axis=axis)
        for name in PLANAR:
            same(name, picture, norm=norm)
        waves = scipy.fft.rfft2(picture)
        for shape in ((12, 15), (12, 14), (10, 15), None):
            same("irfft2", waves, s=shape, norm=norm)
    same("rfft", picture, n=20)
    same("dct", picture, type=3)
    same("rfft2", np.stack([picture, picture]))


def test_a_scipy_that_was_not_checked_answers_by_its_public_functions(monkeypatch):
    for checked in (kernels.CHECKED, ("0.",)):
        monkeypatch.setattr(kernels, "CHECKED", checked)
        found = kernels._loaded.__wrapped__("fft/_pocketfft", "pypocketfft")
        assert (found is not None) == scipy.__version__.startswith(checked)


def test_overwritten_samples_hold_the_result():
    frame = np.ones((4, 8))
    assert np.shares_memory(kernels.dct(frame, type=2, axis=0, overwrite_x=True), frame)


@pytest.mark.parametrize("name", ["ndtr", "expit", "exprel", "j0", "sici", "gammaln", "xlogy"])
def test_special_functions_equal_those_of_scipy(name):
    places = (np.linspace(0.1, 9.0, 50),) * (2 if name == "xlogy" else 1)
    public = getattr(scipy.special, name)(*places)
    assert np.asarray(kernels.special(name)(*places)).tobytes() == np.asarray(public).tobytes()


@pytest.mark.parametrize("kernel", [True, False], ids=["compiled", "public"])
def test_roots_equal_those_of_scipy(kernel, monkeypatch):
    if not kernel:
        monkeypatch.setattr(kernels, "_compiled", lambda *_: None)
    near = {"xtol": 1e-16, "rtol": 1e-13}
    for function, low, high in ((np.cos, 0.0, 3.0), (lambda x: x**3 - 2.0, -9.0, 9.0)):
        public = scipy.optimize.brentq(function, low, high, **near)
        assert kernels.brentq(function, low, high, **near) == public


RACE = """
import threading, time
import numpy as np
from core import kernels

made = kernels.module_from_spec

def slowly(spec):
    module = made(spec)
    time.sleep(0.1)
    return module

kernels.module_from_spec = slowly
found = []
threads = [threading.Thread(target=lambda: found.append(kernels.dct(np.ones(4)))) for _ in "abc"]
for thread in threads: thread.start()
for thread in threads: thread.join()
print(len(found))
"""


def test_threads_that_need_a_kernel_at_once_all_find_it_whole(tmp_path):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = finished([sys.executable, "-c", RACE], folder=tmp_path, env=environment)
    assert done.stdout.split() == ["3"]
