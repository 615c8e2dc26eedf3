"""A periodic frame filtered in blocks of rows, against the definition on the whole plane."""

import itertools
from importlib.util import find_spec

import numpy as np
import pytest

from core import kernels
from core.evaluation.recipes import Store
from core.evaluation.work import Policy, Work
from core.transfer import periodic
from core.transfer import periodic as fourier
from core.transfer.factors import Grid, Law, Planar, Product, Separable
from core.transfer.periodic import periodic_filter, periodic_spectrum

INTERVAL_X, INTERVAL_Y = 1.0, 1.3


def gaussian(frequency, sigma):
    return np.exp(-2 * (np.pi * sigma * frequency) ** 2)


def delay(frequency, by):
    return -2 * np.pi * frequency * by


def leaning(xi, eta):
    return np.exp(-((0.6 * xi + 0.4 * eta) ** 2))


BLUR = Separable(Law.of(gaussian, sigma=0.4), Law.of(gaussian, sigma=0.7))
LATE = Separable(Law.of(delay, by=0.3), Law.of(delay, by=-0.2), part="ptf")


def transfer(xi, eta, leans):
    delays = np.exp(1j * (delay(xi, 0.3) + delay(eta, -0.2)))
    return gaussian(xi, 0.4) * gaussian(eta, 0.7) * delays * (leaning(xi, eta) if leans else 1)


def by_definition(frame, leans):
    """The plain FFT times H; on the row and column of Nyquist, its mean over both signs."""
    rows, columns = frame.shape
    total = np.zeros(frame.shape, complex)
    for sign_y, sign_x in itertools.product((1, -1), repeat=2):
        xi, eta = np.fft.fftfreq(columns, INTERVAL_X), np.fft.fftfreq(rows, INTERVAL_Y)
        xi[columns // 2] *= sign_x
        eta[rows // 2] *= sign_y
        total += 0.25 * transfer(*np.meshgrid(xi, eta), leans)
    return np.fft.ifft2(np.fft.fft2(frame) * total).real


@pytest.mark.parametrize("leans", [False, True], ids=["separable", "leaning"])
@pytest.mark.parametrize(("factor_y", "factor_x"), [(1, 1), (2, 1), (1, 3), (2, 3)])
@pytest.mark.parametrize("rows_a_block", [1, 4, 1000])
def test_the_blocks_of_rows_leave_no_mark(monkeypatch, leans, factor_y, factor_x, rows_a_block):
    rows, columns = 22, 36
    half_width = columns // 2 + 1
    monkeypatch.setattr(periodic, "BLOCK_SAMPLES", rows_a_block * half_width * factor_y)
    frame = np.random.default_rng(3).uniform(20, 60, (rows, columns))
    tilted = (Planar(Law.of(leaning), symmetric=False),) if leans else ()
    work = Work(Policy(precision="double"), Store())
    filtered = periodic_filter(
        work,
        periodic_spectrum(work, frame),
        Product((BLUR, LATE, *tilted)),
        Grid(rows, columns, INTERVAL_X, INTERVAL_Y),
        factor_x,
        factor_y,
    )
    fine = by_definition(frame, leans)
    blocks = fine.reshape(rows // factor_y, factor_y, columns // factor_x, factor_x)
    expected = blocks.mean(axis=(1, 3))
    assert np.abs(filtered - expected).max() <= 1e-12 * np.abs(expected).max()


# Which transforms are in use: installed ones of Intel, else those of scipy.

HAS_INTEL = find_spec("mkl_fft") is not None and find_spec("mkl") is not None


def test_what_is_installed_is_chosen_and_told():
    assert fourier.backend() == ("mkl_fft" if HAS_INTEL else "scipy.fft")


def test_an_installation_that_does_not_load_is_done_without(monkeypatch):
    def refuse(name):
        raise OSError("libmkl_rt.so.2: cannot open shared object file")

    monkeypatch.setattr(fourier, "import_module", refuse)
    fourier.fourier.cache_clear()
    try:
        assert fourier.fourier() is kernels
    finally:
        fourier.fourier.cache_clear()
