"""Combining pixels of a delivered picture is taking its means."""

from __future__ import annotations

import numpy as np
import pytest

from analytic_stages import CHAINS, INTERVAL_X, INTERVAL_Y
from delivered_chains import FOLD_ERROR, PRECISIONS, delivered, scene


@pytest.mark.thorough(but=27)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("chain", CHAINS)
@pytest.mark.parametrize(
    ("size", "factors"),
    [
        ((24, 36), (2, 3)),
        ((21, 20), (7, 4)),
        ((30, 30), (30, 2)),
        ((15, 7), (5, 7)),
        ((1, 12), (1, 6)),
    ],
    ids=str,
)
def test_fold_then_inverse_is_inverse_then_mean(tmp_path, size, factors, chain, edges, precision):
    picture, (fy, fx) = scene(*size), factors
    tail = (("combine_pixels", {"factor_x": fx, "factor_y": fy}),)
    folded, plan = delivered(tmp_path, picture, CHAINS[chain], precision, edges, tail)
    # It was folded: nothing else went over the full frame again.
    assert type(plan.output("tail0.image").recipe).__name__ == "Delivered"
    fine, _ = delivered(tmp_path, picture, CHAINS[chain], precision, edges)
    expected = fine.reshape(size[0] // fy, fy, size[1] // fx, fx).mean(axis=(1, 3))
    assert np.abs(folded - expected).max() <= FOLD_ERROR[precision] * np.abs(expected).max()


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(("size", "left"), [(512, 2), (32, 2), (11, 2)])
def test_combining_by_three_crops(tmp_path, precision, size, left):
    picture = scene(size, size)
    tail = (("combine_pixels", {"factor_x": 3, "factor_y": 3}),)
    found, plan = delivered(tmp_path, picture, ("blur",), precision, "reflect", tail)
    fine, _ = delivered(tmp_path, picture, ("blur",), precision, "reflect")
    kept = size - left
    assert found.shape == (kept // 3, kept // 3)
    expected = fine[:kept, :kept].reshape(kept // 3, 3, kept // 3, 3).mean(axis=(1, 3))
    assert np.abs(found - expected).max() <= FOLD_ERROR[precision] * expected.max()
    image = plan.output("tail0.image")
    assert image.interval_x_mrad == pytest.approx(3 * INTERVAL_X, rel=1e-12)
    assert image.interval_y_mrad == pytest.approx(3 * INTERVAL_Y, rel=1e-12)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("factors", [(2, 3), (5, 4)])
def test_sum_is_mean_times_samples(tmp_path, precision, factors):
    found = {}
    for mode in ("mean", "sum"):
        values = {"factor_y": factors[0], "factor_x": factors[1], "mode": mode}
        tail = (("combine_pixels", values),)
        found[mode], _ = delivered(tmp_path, scene(24, 36), ("blur",), precision, tail=tail)
    expected = found["mean"] * factors[0] * factors[1]
    assert np.abs(found["sum"] - expected).max() <= 3e-7 * expected.max()
