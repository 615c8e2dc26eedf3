"""Choices of a pupil's OTF: closed form or samples, how many, and what is between them."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table
from app.bench.measuring.kodak import Kodak
from app.bench.measuring.timing import paired, round_trip
from app.bench.truth.network_pupils import WAVELENGTH_UM, Otf, expected_at, places_of, pupil_network
from core.chain.wires import Transfer
from core.network.network import Network

SHOWN = ("clear", "half_moon")


def sampling(settings: Settings) -> list[Table]:
    """Closed form against autocorrelations of ever finer samples."""
    kodak = Kodak(settings.small)
    rows = []
    for shape in SHOWN:
        exact = pupil_network(kodak.network, shape, 512)
        named = {"shape": shape, "choice": "exact", "curve": f"{shape}, exact"}
        rows.append({**named, **_evaluated(kodak, exact, shape, 3)})
        for size in _sizes(settings):
            network = _sampled(kodak, shape, size, "bilinear")
            named = {"shape": shape, "choice": f"{size}²", "curve": f"{shape}, sampled"}
            rows.append({**named, **_evaluated(kodak, network, shape, _pairs(settings))})
    heads = {"shape": "pupil", "choice": "OTF", "t0": "T0", "ms": "ms", "error": "largest error"}
    text = (
        "Default exact: no sampled pupil comes near the closed form's error, at any price. Samples "
        "are for pupils from files and with a wavefront error, where there is none; 512² of them "
        "are the default array."
    )
    title = f"Pupil: closed form against autocorrelated samples, {settings.small}² frequencies"
    chart = Chart("t0", "error", "time (T0)", "largest error", "choice", "curve", lines=True)
    return [Table("pupil_sampling", title, heads, tuple(rows), text, chart)]


def interpolation(settings: Settings) -> list[Table]:
    """What is between the lags of a sampled pupil's autocorrelation."""
    kodak = Kodak(settings.small)
    rows = []
    for how in ("none", "linear", "bilinear"):
        for size in _sizes(settings):
            network = _sampled(kodak, "half_moon", size, how)
            measured = _raw if how == "none" else _evaluated
            facts = measured(kodak, network, "half_moon", _pairs(settings))
            rows.append({"choice": how, "size": f"{size}²", **facts})
    heads = {
        "choice": "interpolation",
        "size": "samples",
        "t0": "T0",
        "ms": "ms",
        "error": "largest error",
    }
    text = (
        "Default bilinear: it weighs its four lags alike in every direction. Linear over three has "
        "the smaller error with coarse samples, since its facets follow the cusp at zero lag; with "
        "fine ones both come down to the error of the samples, which is all that `none` has: the "
        "raw autocorrelation at its own lags, only shown, which filters nothing."
    )
    title = f"Interpolation of an autocorrelated half moon, {settings.small}² frequencies"
    chart = Chart("t0", "error", "time (T0)", "largest error", "size", "choice", lines=True)
    return [Table("interpolation", title, heads, tuple(rows), text, chart)]


def _sizes(settings: Settings) -> tuple[int, ...]:
    return (64, 128, 256) if settings.quick else (64, 128, 256, 512, 1024)


def _pairs(settings: Settings) -> int:
    return 2 if settings.quick else 3


def _sampled(kodak: Kodak, shape: str, size: int, how: str) -> Network:
    network = pupil_network(kodak.network, shape, size)
    network = network.with_parameter("optics", "method", "autocorrelation")
    return network.with_parameter("optics", "interpolation", how)


def _evaluated(kodak: Kodak, network: Network, shape: str, pairs: int) -> dict[str, Any]:
    """On every frequency of the picture."""
    otf = Otf(kodak, network)
    t0 = round_trip(kodak.scene, kodak.policy.workers)
    facts = paired(otf.direct, t0, pairs=pairs, warm_up=1).facts()
    places = places_of(len(kodak.scene))
    expected = expected_at(shape, otf.lags_mm(*places))
    return {**facts, "error": float(np.abs(otf.at(*places) - expected).max())}


def _raw(kodak: Kodak, network: Network, shape: str, pairs: int) -> dict[str, Any]:
    """At the autocorrelation's own lags nearest to the frequencies of the others."""
    t0 = round_trip(kodak.scene, kodak.policy.workers)
    facts = paired(lambda: kodak.cold(network, "optics.mtf"), t0, pairs=pairs, warm_up=1).facts()
    transfer = kodak.engine.plan(network).output("optics.mtf")
    assert isinstance(transfer, Transfer)
    assert transfer.own is not None
    sampled = kodak.work.value(transfer.own)
    pitch_x = WAVELENGTH_UM * sampled.interval_x
    pitch_y = WAVELENGTH_UM * sampled.interval_y
    x, y = Otf(kodak, kodak.network).lags_mm(*places_of(len(kodak.scene)))
    columns, rows = np.rint(x / pitch_x).astype(int), np.rint(y / pitch_y).astype(int)
    expected = expected_at(shape, (columns * pitch_x, rows * pitch_y))
    return {**facts, "error": float(np.abs(sampled.values[rows, columns] - expected).max())}


MEASURES = (sampling, interpolation)
