"""Choices that act on whole pictures: precision and edges. The truth is a direct sum."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table
from app.bench.measuring.kodak import PIXELS, Kodak
from app.bench.measuring.timing import paired, round_trip
from app.bench.truth.truth_pictures import Sensor, mirrored_picture, periodic_picture
from core.evaluation.policy import Precision

Array = NDArray[Any]
CHOICE_CHART = Chart("t0", "error", "time (T0)", "largest error", label="choice")


def precision(settings: Settings) -> list[Table]:
    """Single against double precision."""
    single = Kodak(settings.small)
    scene, interval = single.scene, _interval(single)
    expected = mirrored_picture(scene, Sensor(interval))
    rows = []
    kinds: tuple[Precision, ...] = ("single", "double")
    for kind in kinds:
        # The same samples for both, so that drawing in another precision is no error.
        kodak = Kodak(settings.small, kind, scene)
        quiet = kodak.without_photons()
        picture = kodak.value(quiet, PIXELS)
        mean, true_mean = float(picture.mean(dtype=np.float64)), float(expected.mean())
        rows.append(
            {
                "choice": kind,
                **_timed(kodak, quiet, single, settings),
                "error": _error(picture, expected),
                "mean_error": abs(mean - true_mean) / true_mean,
            }
        )
    heads = {
        "choice": "precision",
        "t0": "T0",
        "ms": "ms",
        "error": "error / max",
        "mean_error": "error of the mean, relative",
    }
    text = (
        "Default single: its error is far below the steps of any quantizer in use and the noise, "
        "and its samples take half the room. T0 is that of single precision in both rows."
    )
    title = f"Precision: Kodak optics, {settings.small}², mirrored, against a direct sum"
    return [Table("precision", title, heads, tuple(rows), text, CHOICE_CHART)]


def edges(settings: Settings) -> list[Table]:
    """Mirrored against periodic edges, each against a direct sum of its own kind."""
    kodak = Kodak(settings.small)
    sensor = Sensor(_interval(kodak))
    expected = {
        "reflect": mirrored_picture(kodak.scene, sensor),
        "periodic": periodic_picture(kodak.scene, sensor),
    }
    rows = []
    for choice, picture in expected.items():
        network = kodak.without_photons().with_parameter("init", "edges", choice)
        other = np.abs(picture - expected["reflect"]) / np.abs(expected["reflect"]).max()
        border = min(8, len(other) // 4)
        rows.append(
            {
                "choice": choice,
                **_timed(kodak, network, kodak, settings),
                "error": _error(kodak.value(network, PIXELS), picture),
                "border": float(other.max()),
                "inside": float(other[border:-border, border:-border].max()),
            }
        )
    heads = {
        "choice": "edges",
        "t0": "T0",
        "ms": "ms",
        "error": "error / max",
        "border": "difference from reflect",
        "inside": "the same, 8 samples inside",
    }
    text = (
        "Default reflect: no part of the picture comes from its far side, and no frame is padded "
        "for that; the columns on the right show what repeating the frame would change."
    )
    title = f"Edges: Kodak optics, {settings.small}², single precision, against direct sums"
    return [Table("edges", title, heads, tuple(rows), text, CHOICE_CHART)]


def _interval(kodak: Kodak) -> float:
    plan = kodak.engine.plan(kodak.network)
    interval: float = plan.output("init.context").grid.interval_x_mrad
    return interval


def _timed(kodak: Kodak, network: Any, unit: Kodak, settings: Settings) -> dict[str, Any]:
    t0 = round_trip(unit.scene, unit.policy.workers)
    return paired(lambda: kodak.cold(network, PIXELS), t0, pairs=settings.pairs).facts()


def _error(picture: Array, expected: Array) -> float:
    return float(np.abs(picture - expected).max() / np.abs(expected).max())


MEASURES = (precision, edges)
