"""The nearest rising values, against scipy's and by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import isotonic_regression

from core.physics.measurement.edges.edge_limits import nearest_rising


def test_by_hand():
    assert nearest_rising(values=np.array([1.0, 3.0, 2.0, 2.0, 9.0])).tolist() == pytest.approx(
        [1.0, 7 / 3, 7 / 3, 7 / 3, 9.0]
    )
    assert nearest_rising(values=np.array([])).tolist() == []


@pytest.mark.parametrize("seed", range(4))
def test_as_another_does_it(seed):
    random = np.random.default_rng(seed)
    values = np.sort(random.normal(0.0, 2.0, 300)) + random.normal(0.0, 0.5, 300)
    assert nearest_rising(values=values) == pytest.approx(isotonic_regression(values).x, abs=1e-12)
