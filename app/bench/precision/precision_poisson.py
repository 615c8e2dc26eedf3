"""The choice of drawing Poisson deviates exactly, or normal ones in their place."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table
from app.bench.measuring.kodak import Kodak
from app.bench.measuring.timing import paired, round_trip, seconds
from app.bench.truth.truth_laws import poisson_cumulative
from core.noise.random_fields import Stream, normal_field, poisson_field
from core.physics.electrons.poisson_quantile import poisson_of_normal
from core.threads import ForEach

Array = NDArray[Any]
MEANS = (0.0034, 0.3, 3.0, 30.0, 300.0, 3000.0)  # the two first: the thesis' sensors
_ROWS = 32
CHANCE = 1.36  # 95 of 100 samples of n stay within 1.36/√n of their law (Kolmogorov)


def poisson(settings: Settings) -> list[Table]:
    """Time, and how far the deviates' distribution is from Poisson's."""
    kodak = Kodak(settings.size)
    shape, workers, for_each = kodak.scene.shape, kodak.policy.workers, kodak.work.for_each
    t0 = round_trip(kodak.scene, workers)
    chance = CHANCE / math.sqrt(kodak.scene.size)
    rows = []
    for mean in MEANS:
        means = np.full(shape, mean, kodak.policy.dtype)
        stream = Stream(seed=1996, node="photons", field="photons")
        plain = np.random.default_rng(1996)
        subjects: tuple[tuple[str, Callable[[], Any], int], ...] = (
            ("exact", partial(poisson_field, means, stream, for_each=for_each), workers),
            ("exact, numpy", partial(plain.poisson, means), 1),
            ("rounded normal", partial(_rounded_normal, means, stream, for_each), workers),
            ("quantile of a normal", partial(_quantile, means, stream, for_each), workers),
        )
        for choice, subject, threads in subjects:
            counts = np.asarray(subject())
            timing = paired(partial(seconds, subject), t0, pairs=settings.slow_pairs, warm_up=1)
            spread = float(counts.var(dtype=np.float64)) / mean
            rows.append(
                {
                    "choice": choice,
                    "mean": mean,
                    "mark": None if choice == "exact, numpy" else f"{mean:g}",
                    "threads": threads,
                    **timing.facts(),
                    "error": kolmogorov_distance(counts, mean),
                    "chance": chance,
                    "variance": spread - 1.0,
                }
            )
    heads = {
        "choice": "deviates",
        "mean": "mean",
        "threads": "threads",
        "t0": "T0",
        "ms": "ms",
        "error": "Kolmogorov distance",
        "chance": "chance allows",
        "variance": "variance / mean − 1",
    }
    text = (
        "Default exact, at every mean up to 1e12: normal deviates, rounded to counts, err most "
        "where photons are few, and there the exact way is the faster, since it draws the events "
        "alone. From a few photons a sample on normal ones are faster, and their distance falls as "
        "1/√mean. The distance is the largest between the deviates' distribution and Poisson's; 95 "
        f"of 100 exact fields of {settings.size}² stay below {chance:.1g}."
    )
    title = f"Poisson deviates, and normal ones in their place: {settings.size}² samples"
    chart = Chart(
        "t0",
        "error",
        "time (T0)",
        "Kolmogorov distance from Poisson",
        "mark",
        "choice",
        lines=True,
        title=f"{title}, by their mean",
        floor=(chance, "below: chance"),
    )
    return [Table("poisson", title, heads, tuple(rows), text, chart)]


def kolmogorov_distance(counts: Array, mean: float) -> float:
    """Largest difference between the counts' distribution function and Poisson's."""
    law = poisson_cumulative(mean)
    histogram = np.bincount(np.clip(counts, 0, len(law) - 1).astype(np.int64).ravel())
    share = np.cumsum(np.pad(histogram, (0, len(law) - len(histogram)))) / counts.size
    return float(np.abs(share - law).max())


def _rounded_normal(means: Array, stream: Stream, for_each: ForEach) -> Array:
    """The approximation: a normal deviate of the same mean and variance, to the nearest count."""
    counts = normal_field(stream, means.shape, dtype=means.dtype, for_each=for_each)
    counts *= np.sqrt(means)
    counts += means
    np.rint(counts, out=counts)
    return np.maximum(counts, 0, out=counts)


def _quantile(means: Array, stream: Stream, for_each: ForEach) -> Array:
    """Poisson's quantile of a normal deviate, as a focal plane draws its shot noise."""
    deviates = normal_field(stream, means.shape, dtype=means.dtype, for_each=for_each)
    counts = np.empty_like(means)

    def block(top: int) -> None:
        rows = slice(top, top + _ROWS)
        poisson_of_normal(means[rows], deviates[rows], out=counts[rows])

    for_each(block, range(0, means.shape[0], _ROWS))
    return counts


MEASURES = (poisson,)
