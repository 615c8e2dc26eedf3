"""What a network delivers against the analytic transfer functions."""

from __future__ import annotations

import numpy as np
import pytest

from analytic_stages import ALL, CHAINS, INTERVAL_X, analytic, expected_h
from delivered_chains import (
    MEAN_ERROR,
    MTF_ERROR,
    PRECISIONS,
    SHIFT_ERROR,
    delivered,
    scene,
)

SIZES = [(31, 17), (24, 10), (32, 32), (9, 20), (1, 16), (13, 1), (2, 2), (1, 1)]


@pytest.mark.thorough(but=22)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize("size", SIZES, ids=str)
def test_delivered_mtf_is_the_analytic_product(tmp_path, size, chain, precision):
    rows, columns = size
    at = rows // 3, columns // 2
    point = np.zeros(size)
    point[at] = 1.0
    found, _ = delivered(tmp_path, point, CHAINS[chain], precision)
    # The FFT of the point itself, written as its phases, goes out of the FFT of the picture.
    towards = np.exp(
        2j * np.pi * (np.outer(np.fft.fftfreq(rows) * at[0], np.ones(columns))
                      + np.fft.fftfreq(columns) * at[1])
    )  # fmt: skip
    expected = expected_h(CHAINS[chain], rows, columns)
    assert np.abs(np.fft.fft2(found) * towards - expected).max() <= MTF_ERROR[precision]


@pytest.mark.parametrize("edges", ["periodic", "reflect"])
@pytest.mark.parametrize("stages", [("optics",), ("optics", "pixel", "late"), ("smear", "late")])
def test_single_precision_where_planes_are_approximated(tmp_path, edges, stages):
    rows, columns = 144, 262
    picture = scene(rows, columns)
    found, _ = delivered(tmp_path, picture, stages, "single", edges)
    frame = picture
    if edges == "reflect":
        frame = np.block([[picture, picture[:, ::-1]], [picture[::-1], picture[::-1, ::-1]]])
    h = expected_h(stages, *frame.shape, kind=np.float64)
    expected = np.fft.ifft2(np.fft.fft2(frame) * h).real[:rows, :columns]
    assert np.abs(found - expected).max() <= 2e-6 * np.abs(expected).max()


# ---------------------------------------------------------------- mean and shift


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(("edges", "chain"), [
    ("periodic", "whole chain"), ("periodic", "sampled by rows"), ("reflect", "symmetric"),
])  # fmt: skip
@pytest.mark.parametrize("size", [(31, 17), (48, 20), (1, 16), (64, 64)], ids=str)
@pytest.mark.parametrize("level", [0.0, 1e5])
def test_mean_radiance_is_kept(tmp_path, size, chain, edges, precision, level):
    picture = (scene(*size) + level).astype(np.float32).astype(float)
    found, _ = delivered(tmp_path, picture, CHAINS[chain], precision, edges)
    assert abs(found.mean() / picture.mean() - 1) <= MEAN_ERROR[precision]


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("stages", [("late",), ("published",), ALL])
@pytest.mark.parametrize("size", [(31, 17), (10, 24), (32, 32)], ids=str)
def test_shift_from_the_first_bin(tmp_path, size, stages, precision):
    picture = np.zeros(size)
    picture[1, 2] = 1.0
    found, _ = delivered(tmp_path, picture, stages, precision)
    columns = size[1]
    ratio = np.fft.fft2(found)[0, 1] / np.fft.fft2(picture)[0, 1]
    first = 1 / (columns * INTERVAL_X)
    true = np.prod([analytic(stage, np.array([[first]]), np.zeros((1, 1))) for stage in stages])
    shift, expected = (-np.angle(h) * columns / (2 * np.pi) for h in (ratio, true))
    assert abs(shift - expected) <= SHIFT_ERROR[precision]
    # A delay: to +x.
    assert shift > 0
