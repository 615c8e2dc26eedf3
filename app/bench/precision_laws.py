"""Choices of laws and deviates: charge transfer, and how Poisson deviates are drawn."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench import truth
from app.bench.kodak import Kodak
from app.bench.settings import Settings
from app.bench.tables import Chart, Table
from app.bench.timing import paired, round_trip, seconds
from core.physics.charge_transfer import MODELS, charge_transfer_mtf, charge_transfer_ptf
from core.streams import Stream, poisson_field

Array = NDArray[Any]
SETTINGS = ((640, "0.99999"), (640, "0.999"), (2048, "0.995"))
MEANS = (0.0034, 0.3, 3.0, 30.0)


def charge_transfer(settings: Settings) -> list[Table]:
    """Published, leading and exact transfer functions against the product of all transfers."""
    title = "Charge transfer: H = MTF·exp(i·PTF) against the product of all transfers"
    heads = {
        "choice": "model",
        "setting": "N(1 − ε)",
        "t0": "T0",
        "mtf": "error of MTF",
        "ptf": "error of PTF, rad",
        "error": "error of H",
    }
    mp = truth.mpmath()
    if mp is None:
        return [Table("charge_transfer", title, heads, (), truth.NEEDS_MPMATH)]
    kodak = Kodak(settings.small)
    t0 = round_trip(kodak.scene, kodak.policy.workers)
    w = np.linspace(0.0, math.pi, 65)
    full = np.linspace(0.0, math.pi, settings.small)
    rows: list[dict[str, Any]] = []
    for transfers, efficiency in SETTINGS:
        expected = np.array([truth.charge_transfer(mp, x, transfers, efficiency) for x in w])
        mtf, ptf = expected.T
        lost = f"{transfers} × {1 - float(efficiency):.3g}"
        for model in MODELS:
            how: dict[str, Any] = {
                "transfers": transfers,
                "efficiency": float(efficiency),
                "model": model,
            }

            both = partial(_both, full, how)
            found = charge_transfer_mtf(phase_per_transfer=w, **how)
            turned = charge_transfer_ptf(phase_per_transfer=w, **how)
            both_wrong = np.abs(found * np.exp(1j * turned) - mtf * np.exp(1j * ptf))
            rows.append(
                {
                    "choice": model,
                    "setting": lost,
                    **paired(partial(seconds, both), t0, pairs=settings.pairs).facts(),
                    "mtf": float(np.abs(found - mtf).max()),
                    "ptf": float(np.abs(turned - ptf).max()),
                    "error": float(both_wrong.max()),
                }
            )
    text = (
        "Default exact: a vector along one axis costs nothing beside the picture, and the "
        "published phase is another law, which starts with w³ instead of w."
    )
    chart = Chart("t0", "error", "time (T0)", "largest error of H", "choice", "setting")
    return [Table("charge_transfer", title, heads, tuple(rows), text, chart)]


def _both(w: Array, how: dict[str, Any]) -> None:
    charge_transfer_mtf(phase_per_transfer=w, **how)
    charge_transfer_ptf(phase_per_transfer=w, **how)


def poisson(settings: Settings) -> list[Table]:
    """Thinning against one plain deviate for every sample; both are exact."""
    kodak = Kodak(settings.size)
    shape, workers = kodak.scene.shape, kodak.policy.workers
    t0 = round_trip(kodak.scene, workers)
    rows = []
    for mean in MEANS:
        means = np.full(shape, mean, kodak.policy.dtype)
        stream = Stream(seed=1996, node="photons", field="photons")
        plain = np.random.default_rng(1996)
        subjects: tuple[tuple[str, Callable[[], Any], int], ...] = (
            ("ours", partial(poisson_field, means, stream, each=kodak.work.each), workers),
            ("numpy", partial(plain.poisson, means), 1),
        )
        for choice, subject, threads in subjects:
            counts = np.asarray(subject())
            found = paired(partial(seconds, subject), t0, pairs=settings.slow_pairs, warm_up=1)
            deviation = (float(counts.mean(dtype=np.float64)) - mean) / math.sqrt(
                mean / counts.size
            )
            rows.append(
                {
                    "mean": mean,
                    "choice": choice,
                    **found.facts(),
                    "threads": threads,
                    "mean_off": deviation,
                }
            )
    heads = {
        "mean": "mean",
        "choice": "deviates",
        "threads": "threads",
        "t0": "T0",
        "ms": "ms",
        "mean_off": "mean off, in its σ",
    }
    text = (
        "Both have exactly the Poisson distribution: small means are thinned from one larger rate, "
        "not approximated. Ours are the default: they do not depend on the number of threads, and "
        "a field of few events costs little more than its events."
    )
    title = f"Poisson deviates for {settings.size}² samples (time only)"
    chart = Chart("mean", "t0", "mean of the deviates", "time (T0)", group="choice", lines=True)
    return [Table("poisson", title, heads, tuple(rows), text, chart)]


MEASURES = (charge_transfer, poisson)
