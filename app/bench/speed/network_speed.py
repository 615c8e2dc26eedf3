"""Speed of the whole Kodak network and of single edits, in T0."""

from __future__ import annotations

import statistics
import subprocess
import tempfile
from collections.abc import Callable
from typing import Any

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table, verdict
from app.bench.measuring.isolation import environment
from app.bench.measuring.kodak import FINAL, NAME, PIXELS, SHIPPED_SIZE, Kodak
from app.bench.measuring.timing import paired, round_trip, seconds
from app.bench.speed.camera_speed import cameras
from app.bench.speed.frame_speed import frames
from app.bench.speed.growth import growth
from app.bench.truth.stage_by_stage import whole_chain
from app.run.own_process import command

HEADS = {
    "subject": "subject",
    "value": "median",
    "unit": "",
    "low": "25 %",
    "high": "75 %",
    "ms": "ms",
    "t0_ms": "T0 ms",
    "alone_ms": "T0 ms, back to back",
    "reach": "reach",
    "aim": "aim",
    "verdict": "",
}
BRIEF = tuple(name for name in HEADS if name != "alone_ms")
SIGMAS = tuple(0.1 + 1e-3 * step for step in range(1, 32))
SNRS = tuple(100.0 + step for step in range(1, 32))
BITS = (4, 8, 12, 16, 24)
LOOKS = 20  # repetitions of what takes microseconds


def networks(settings: Settings) -> list[Table]:
    """Cold runs, edits, nothing changed and the plain way of 1996."""
    kodak = Kodak(settings.size)
    rows = [*_cold(kodak, settings), *_edits(kodak, settings), _plain(kodak, settings)]
    rows += [_unchanged(kodak, settings)]
    title = f"Kodak KIR-310, {settings.size}² → {settings.size // 2}², single precision"
    text = (
        "Cold: nothing computed but the scene, which is in memory; imports done. Median and "
        "quartiles of the ratios of pairs, the subject and T0 in turn."
    )
    chart = Chart(
        "value",
        "ms",
        "time (T0)",
        "",
        kind="bars",
        where=("unit", "T0"),
        title=f"Time of the whole chain and of edits: {title}",
    )
    return [Table("networks", title, HEADS, tuple(rows), text, chart, BRIEF)]


def one_thread(settings: Settings) -> list[Table]:
    """The same without a second thread, T0 too."""
    kodak = Kodak(settings.size, threads=1)
    rows = (*_cold(kodak, settings), *_edits(kodak, settings))
    title = f"The same on one thread, {settings.size}² → {settings.size // 2}²"
    text = (
        "T0 is that of one thread. What is planned, drawn up and summed between the large loops "
        "runs on one thread in either table, and counts more where the loops run on several."
    )
    return [Table("one_thread", title, HEADS, rows, text, brief=BRIEF)]


def _row(subject: str, facts: dict[str, Any], reach: float | None, aim: float | None) -> Any:
    value = facts.pop("t0")
    return {
        "subject": subject,
        "value": value,
        "unit": "T0",
        **facts,
        "reach": reach,
        "aim": aim,
        "verdict": verdict(value, reach, aim),
    }


def _cold(kodak: Kodak, settings: Settings) -> list[Any]:
    t0 = round_trip(kodak.scene, kodak.policy.workers)
    whole, quiet = kodak.network, kodak.without_photons()
    sensor, every = ("electronics",), tuple(whole.nodes)
    subjects: list[tuple[str, Callable[[], float], float, float]] = [
        ("whole network", lambda: kodak.cold(whole, FINAL, sensor), 5.0, 2.5),
        ("whole, read-outs of every node", lambda: kodak.cold(whole, FINAL, every), 5.0, 2.5),
        ("without photon noise", lambda: kodak.cold(quiet, FINAL, sensor), 4.0, 2.0),
        ("optics alone, pixels combined", lambda: kodak.cold(quiet, PIXELS), 2.2, 1.2),
    ]
    return [
        _row(name, paired(subject, t0, pairs=settings.pairs).facts(), reach, aim)
        for name, subject, reach, aim in subjects
    ]


def _edits(kodak: Kodak, settings: Settings) -> list[Any]:
    t0 = round_trip(kodak.scene, kodak.policy.workers)
    kodak.store.clear()
    warm = kodak.warm()
    edits: list[tuple[str, str, str, tuple[Any, ...], float, float]] = [
        ("edit of an MTF (aberration)", "aberration", "sigma_x_mrad", SIGMAS, 2.0, 1.0),
        ("edit of the amplifier's SNR", "electronics", "amplifier_snr", SNRS, 0.5, 0.25),
        ("edit of the bits", "electronics", "bits", BITS, 0.5, 0.25),
    ]
    rows = []
    for name, node, parameter, values, reach, aim in edits:

        def subject(edit: tuple[str, str, tuple[Any, ...]] = (node, parameter, values)) -> float:
            return kodak.edited(*edit, warm)

        rows.append(_row(name, paired(subject, t0, pairs=settings.pairs).facts(), reach, aim))
    return rows


def _plain(kodak: Kodak, settings: Settings) -> Any:
    """In double precision, numpy's default."""
    t0 = round_trip(kodak.scene, kodak.policy.workers)
    grabber = kodak.network.nodes["frame_grabber"].params
    size = {"lines": grabber["height"], "samples": grabber["width"]}

    def subject() -> float:
        return seconds(lambda: whole_chain(kodak.scene, **size, seed=1996))

    timing = paired(subject, t0, pairs=settings.slow_pairs, warm_up=1)
    name = "stage by stage as in 1996, numpy, no photon noise"
    return _row(name, timing.facts(), None, None)


def _unchanged(kodak: Kodak, settings: Settings) -> Any:
    kodak.value(kodak.network, FINAL)
    before = kodak.engine.plan(kodak.network)
    count = len(kodak.network.nodes)
    times_us = sorted(
        kodak.looked_at_again(before) / count * 1e6 for _ in range(settings.pairs * LOOKS)
    )
    low, middle, high = statistics.quantiles(times_us, n=4)
    return {
        "subject": "nothing changed",
        "value": middle,
        "unit": "µs a node",
        "low": low,
        "high": high,
        "reach": 50.0,
        "verdict": verdict(middle, 50.0, None),
    }


def fresh_process(settings: Settings) -> list[Table]:
    """``imagechain run`` from the start of its process to the end."""
    took = []
    with tempfile.TemporaryDirectory() as folder:
        words = command("app.command.cli", "run", NAME, "--output-dir", f"{folder}/out")
        if settings.size != SHIPPED_SIZE:
            words += ["--set", f"scene.width={settings.size}"]
            words += ["--set", f"scene.height={settings.size}"]
        for _ in range(settings.starts):
            took.append(
                seconds(
                    lambda: subprocess.run(
                        words, cwd=folder, env=environment(), capture_output=True, check=True
                    )
                )
            )
    took.sort()
    value = statistics.median(took)
    row = {
        "subject": f"imagechain run {NAME}",
        "value": value,
        "unit": "s",
        "low": took[0],
        "high": took[-1],
        "reach": 1.2,
        "aim": 0.6,
        "verdict": verdict(value, 1.2, 0.6),
    }
    heads = {**{n: h for n, h in HEADS.items() if not n.endswith("ms")}, "low": "least",
             "high": "most"}  # fmt: skip
    title = f"Fresh process, {settings.size}², median of {len(took)}"
    text = "With the start of Python, the drawing of the scene and the files written."
    return [Table("fresh_process", title, heads, (row,), text, brief=tuple(heads))]


MEASURES = (networks, one_thread, cameras, frames, growth, fresh_process)
