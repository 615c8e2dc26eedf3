"""The choice of how far to expand the quantile by which a normal deviate becomes a count."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Table
from app.bench.truth.truth_laws import poisson_cumulative
from core.physics.electrons.poisson_quantile import poisson_of_normal

Array = NDArray[Any]
MEANS = (0.3, 3.0, 15.9, 16.0, 40.0, 64.0, 200.0, 1e3, 1e4, 1e5)


def quantiles(_settings: Settings) -> list[Table]:
    """How far the quantile of a normal deviate is from Poisson's, without drawing any."""
    rows = []
    for mean in MEANS:
        count, chance = _chances(mean)
        law = np.diff(poisson_cumulative(mean), prepend=0.0)
        exact = np.zeros(max(len(law), len(chance)))
        exact[: len(law)] = law
        exact[: len(chance)] -= chance
        first = float(chance @ count)
        second = float(chance @ (count - first) ** 2)
        third = float(chance @ (count - first) ** 3)
        rows.append(
            {
                "mean": mean,
                "distance": 0.5 * float(np.abs(exact).sum()),
                "mean_error": first / mean - 1.0,
                "variance": second / mean - 1.0,
                "skewness": third / second**1.5 * math.sqrt(mean) - 1.0,
            }
        )
    heads = {
        "mean": "mean",
        "distance": "total variation distance",
        "mean_error": "mean, relative error",
        "variance": "variance, relative error",
        "skewness": "skewness, relative error",
    }
    text = (
        "Shot noise of a focal plane is the quantile of Poisson's distribution at a unit normal "
        "deviate: below a mean of 16 it is summed, from there expanded (Giles 2016) to 1/mean, "
        "from 64 on to 1/√mean. A test of n samples sees a distance from about 1/√n on: one of "
        "1e-5 takes 1e10 samples."
    )
    title = "Poisson counts of normal deviates, against the exact distribution"
    return [Table("poisson_quantile", title, heads, tuple(rows), text)]


def _chances(mean: float) -> tuple[Array, Array]:
    """Counts, and how probable a normal deviate makes them: where the count steps, by halving."""
    count = np.arange(0.0, mean + 8.0 * math.sqrt(mean) + 12.0)
    low, high = np.full(count.size, -9.0), np.full(count.size, 9.0)
    means = np.full(count.size, mean)
    for _ in range(70):
        middle = (low + high) / 2.0
        below = poisson_of_normal(means, middle) < count
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return count, np.diff(np.append(special.ndtr(low), 1.0))


MEASURES = (quantiles,)
