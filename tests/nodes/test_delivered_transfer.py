"""What a network delivers against the analytic transfer functions."""

from __future__ import annotations

import numpy as np
import pytest

from analytic_stages import (
    ALL,
    CHAINS,
    INTERVAL_X,
    INTERVAL_Y,
    PUPIL,
    STAGES,
    analytic,
    expected_h,
    plane,
)
from core.engine import Engine
from core.policy import Policy
from delivered_chains import (
    LIBRARY,
    MEAN_ERROR,
    MTF_ERROR,
    PRECISIONS,
    SHIFT_ERROR,
    delivered,
    scene,
)

SIZES = [(31, 17), (24, 10), (32, 32), (9, 20), (1, 16), (13, 1), (2, 2), (1, 1)]


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
    expected = expected_h(chain, rows, columns)
    assert np.abs(np.fft.fft2(found) * towards - expected).max() <= MTF_ERROR[precision]


@pytest.mark.parametrize("stage", STAGES)
def test_each_stage_alone_and_as_shown(tmp_path, stage):
    rows, columns = 15, 12
    point = np.zeros((rows, columns))
    point[0, 0] = 1.0
    found, plan = delivered(tmp_path, point, (stage,), "double")
    expected = np.mean(
        [plane(stage, rows, columns, fy, fx) for fy in (False, True) for fx in (False, True)],
        axis=0,
    )
    assert np.abs(np.fft.fft2(found) - expected).max() <= 1e-12
    engine = Engine(LIBRARY)
    work = engine.work(Policy(precision="double"))
    shown = np.ones((rows, columns), complex)
    if "mtf" in plan.nodes[stage].outputs:
        shown = shown * engine.value(plan, f"{stage}.mtf", work)
    if "ptf" in plan.nodes[stage].outputs:
        shown = shown * np.exp(1j * engine.value(plan, f"{stage}.ptf", work))
    assert np.abs(shown - plane(stage, rows, columns, False, False)).max() <= 1e-12


@pytest.mark.parametrize("edges", ["periodic", "reflect"])
@pytest.mark.parametrize("stages", [("optics",), ("optics", "pixel", "late"), ("smear", "late")])
def test_single_precision_where_planes_are_approximated(tmp_path, edges, stages):
    rows, columns = 144, 262
    picture = scene(rows, columns)
    found, _ = delivered(tmp_path, picture, stages, "single", edges)
    frame = picture
    if edges == "reflect":
        frame = np.block([[picture, picture[:, ::-1]], [picture[::-1], picture[::-1, ::-1]]])
    h = fast_h(stages, *frame.shape)
    expected = np.fft.ifft2(np.fft.fft2(frame) * h).real[:rows, :columns]
    assert np.abs(found - expected).max() <= 2e-6 * np.abs(expected).max()


def fast_h(stages, rows, columns):
    """As `expected_h`, the ring in plain double precision."""
    total = np.zeros((rows, columns), complex)
    for sign_y, sign_x in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        xi, eta = np.fft.fftfreq(columns, INTERVAL_X), np.fft.fftfreq(rows, INTERVAL_Y)
        xi[np.arange(columns) * 2 == columns] *= sign_x
        eta[np.arange(rows) * 2 == rows] *= sign_y
        h = np.ones((rows, columns), complex)
        for stage in stages:
            if stage == "optics":
                h *= fast_ring(np.hypot(10 * xi / 0.5, 10 * eta[:, np.newaxis] / 0.375))
            else:
                h *= analytic(stage, xi, eta[:, np.newaxis])
        total += h / 4
    return total


def fast_ring(lag):
    a, b = float(PUPIL["radius"]), float(PUPIL["obscuration_radius"])

    def shared(one, two):
        d = np.clip(lag, abs(one - two) + 1e-12, one + two)
        angles = [
            r * r * np.arccos(np.clip((d * d + r * r - s * s) / (2 * d * r), -1, 1))
            for r, s in ((one, two), (two, one))
        ]
        inner = (one + two - d) * (d + one - two) * (d - one + two) * (d + one + two)
        area = sum(angles) - np.sqrt(np.maximum(inner, 0)) / 2
        return np.where(lag <= abs(one - two), np.pi * min(one, two) ** 2, area)

    return (shared(a, a) - 2 * shared(a, b) + shared(b, b)) / (np.pi * (a * a - b * b))


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
