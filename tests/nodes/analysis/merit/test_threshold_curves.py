"""Curves of smallest detectable differences, where the samples are no squares."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from core.evaluation.policy import Policy
from core.evaluation.store import Store
from core.evaluation.work import Work
from core.physics.noise.noise_components import NoiseVariances
from core.transfer.factors import Grid
from nodes.analysis.threshold_curves import Observer, Sensitivity, mdtd_curve

NETD_K = 0.1


@pytest.mark.thorough(always=("0.001-", "1e-09-"))
@pytest.mark.parametrize("window", ["target", "image"])
@pytest.mark.parametrize("interval_y_mrad", [1e-3, 1e-6, 1e-9])
def test_mdtd_of_samples_of_very_different_sides(interval_y_mrad, window):
    """Nothing is blurred: the noise that is left after averaging is all there is.

    Of white noise sinc² averages across, and along, where a target has very many samples, the
    inverse of their number is left.
    """
    observer = Observer("ratches_1976", True, True, 2.25, 1.0, window, None)
    noise = Sensitivity(0.0, 300.0, 1.0, NoiseVariances(tvh=NETD_K**2))
    grid = Grid(16, 16, 1.0, interval_y_mrad)
    work = Work(Policy(), Store(0))
    curve = mdtd_curve(work, noise, stages=(), grid=grid, observer=observer)
    (series,) = curve.series
    assert series.x[[0, -1]] == pytest.approx([0.25, 25.0])  # by the longer side
    for size, mdtd in zip(series.x[::24], series.y[::24], strict=True):
        across = 2.0 * quad(lambda at, w=size: np.sinc(w * at) ** 2, 0.0, 0.5, limit=200)[0]
        along = interval_y_mrad / size
        expected = 2.25 * NETD_K * np.sqrt(across * along)
        # What the sums leave out, twice, and the approximation of `along`.
        assert mdtd == pytest.approx(expected, rel=2e-3 + interval_y_mrad)
