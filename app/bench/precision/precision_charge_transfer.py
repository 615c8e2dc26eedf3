"""The choice of the law of charge transfer."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table, figure_text
from app.bench.measuring.kodak import Kodak
from app.bench.measuring.timing import paired, round_trip, seconds
from app.bench.truth import truth_laws as truth
from core.physics.detector.charge_transfer import MODELS, charge_transfer_mtf, charge_transfer_ptf

Array = NDArray[Any]
SETTINGS = ((640, "0.99999"), (640, "0.999"), (2048, "0.995"))


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
        lost = f"{transfers} × {figure_text(1 - float(efficiency))}"
        for model in MODELS:
            how: dict[str, Any] = {
                "transfers": transfers,
                "efficiency": float(efficiency),
                "model": model,
            }

            both = partial(_both, full, how)
            computed_mtf = charge_transfer_mtf(phase_per_transfer=w, **how)
            turned = charge_transfer_ptf(phase_per_transfer=w, **how)
            both_wrong = np.abs(computed_mtf * np.exp(1j * turned) - mtf * np.exp(1j * ptf))
            rows.append(
                {
                    "choice": model,
                    "setting": lost,
                    **paired(partial(seconds, both), t0, pairs=settings.pairs).facts(),
                    "mtf": float(np.abs(computed_mtf - mtf).max()),
                    "ptf": float(np.abs(turned - ptf).max()),
                    "error": float(both_wrong.max()),
                }
            )
    text = (
        "Default exact: a vector along one axis costs nothing beside the picture, and the "
        "published phase is another law, which starts with w³ instead of w."
    )
    chart = Chart(
        "t0",
        "error",
        "time (T0)",
        "largest error of H",
        "setting",
        "choice",
        title="Charge transfer against the product of all transfers, by N × (1 − ε)",
    )
    return [Table("charge_transfer", title, heads, tuple(rows), text, chart)]


def _both(w: Array, how: dict[str, Any]) -> None:
    charge_transfer_mtf(phase_per_transfer=w, **how)
    charge_transfer_ptf(phase_per_transfer=w, **how)


MEASURES = (charge_transfer,)
