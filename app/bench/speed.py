"""Speed of whole networks and of edits of them, in T0."""

import statistics
import subprocess
import tempfile
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from app.bench import timing
from app.bench.tables import Chart, Table, judged
from app.run.terminal import command
from core.arrays import Array
from core.errors import several

Subject = tuple[str, Callable[[], float], float | None, float | None]
TARGETS = {"reach": "limit", "aim": "target", "verdict": ""}
HEADS = {
    "subject": "subject", "value": "median", "unit": "", "low": "25 %", "high": "75 %",
    "ms": "ms", "t0_ms": "T0 ms", "alone_ms": "T0 ms, back to back", **TARGETS,
}  # fmt: skip
SIGMAS = tuple(0.1 + 1e-3 * step for step in range(1, 32))
SNRS = tuple(100.0 + step for step in range(1, 32))
LOOKS = 20  # repetitions of what takes microseconds


def networks(settings: timing.Settings) -> list[Table]:
    kodak = timing.kodak_chain(settings.size)
    rows = [*_cold_and_edited(kodak, settings), _plain(kodak, settings)]
    rows += [_unchanged(kodak, settings)]
    title = f"Kodak KIR-310, {settings.size}² → {settings.size // 2}², single precision"
    text = (
        "The first four rows start cold: modules are imported, but only the scene is in memory. "
        "Figures are the median and quartiles of the ratio to T0; each subject and T0 are timed "
        "alternately."
    )
    name = f"Time of the whole chain and of edits: {title}"
    chart = Chart(title=name, where=("unit", "T0"))
    return [Table("networks", title, HEADS, rows, text, chart)]


def one_thread(settings: timing.Settings) -> list[Table]:
    rows = _cold_and_edited(timing.kodak_chain(settings.size, threads=1), settings)
    title = f"Whole chain and edits on one thread, {settings.size}² → {settings.size // 2}²"
    text = (
        "T0 is measured on one thread. The work between the large loops (planning, noise, "
        "sums) always runs on one thread, so it takes a larger share of the time when the loops "
        "use several threads."
    )
    return [Table("one_thread", title, HEADS, rows, text)]


def _cold_and_edited(kodak: timing.Chain, settings: timing.Settings) -> list[Any]:
    whole, quiet = kodak.network, timing.without_photons(kodak.network)
    sensor, read = ("electronics",), partial(kodak.cold, whole, timing.FINAL, tuple(whole.nodes))
    cold: list[Subject] = [
        ("whole network", partial(kodak.cold, whole, timing.FINAL, sensor), 5.0, 2.5),
        ("whole network, with read-outs of every node", read, 5.0, 2.5),
        ("without photon noise", partial(kodak.cold, quiet, timing.FINAL, sensor), 4.0, 2.0),
        ("optics alone, pixels combined", partial(kodak.cold, quiet, timing.PIXELS), 2.2, 1.2),
    ]
    rows = timed(kodak, cold, settings)
    warm = kodak.left_by(timing.FINAL)
    mtf, snr = ("aberration", "sigma_x_mrad", SIGMAS), ("electronics", "amplifier_snr", SNRS)
    bits = ("electronics", "bits", (4, 8, 12, 16, 24))
    edits: list[Subject] = [
        ("edit of an MTF (aberration)", partial(kodak.edited, timing.FINAL, warm, mtf), 2.0, 1.0),
        ("edit of the amplifier's SNR", partial(kodak.edited, timing.FINAL, warm, snr), 0.5, 0.25),
        ("edit of the number of bits", partial(kodak.edited, timing.FINAL, warm, bits), 0.5, 0.25),
    ]
    return rows + timed(kodak, edits, settings)


def timed(chain: timing.Chain, subjects: list[Subject], settings: timing.Settings) -> list[Any]:
    rows = []
    for name, subject, reach, aim in subjects:
        facts = timing.paired(subject, chain.t0, pairs=settings.pairs)
        rows.append(_row(name, facts, reach, aim) | {"threads": chain.policy.workers})
    return rows


def _row(name: str, facts: dict[str, Any], reach: float | None, aim: float | None) -> Any:
    value = facts.pop("t0")
    return {"subject": name, "value": value, "unit": "T0", **facts, **judged(value, reach, aim)}


def _plain(kodak: timing.Chain, settings: timing.Settings) -> Any:
    """In double precision, numpy's default."""
    grabber = kodak.network.nodes["frame_grabber"].params
    subject = partial(whole_chain, kodak.scene, grabber["height"], grabber["width"], 1996)
    took = timing.paired(
        partial(timing.seconds, subject), kodak.t0, pairs=settings.slow_pairs, warm_up=1
    )
    name = "stage by stage as in 1996, numpy, no photon noise"
    return _row(name, took, None, None)


def _unchanged(kodak: timing.Chain, settings: timing.Settings) -> Any:
    kodak.value(kodak.network, timing.FINAL)
    before = kodak.engine.plan(kodak.network)
    per_node = 1e6 / len(kodak.network.nodes)
    again = partial(kodak.looked_at_again, timing.FINAL, before, kodak.network)
    times_us = [again() * per_node for _ in range(settings.pairs * LOOKS)]
    low, middle, high = statistics.quantiles(times_us, n=4)
    row = {"subject": "nothing changed", "value": middle, "unit": "µs per node"}
    return {**row, "low": low, "high": high, **judged(middle, 50.0)}


def fresh_process(settings: timing.Settings) -> list[Table]:
    with tempfile.TemporaryDirectory() as folder:
        words = command("app.command.cli", "run", timing.KODAK, "--output-dir", f"{folder}/out")
        if settings.size != timing.SHIPPED_SIZE:
            words += ["--set", f"scene.width={settings.size}"]
            words += ["--set", f"scene.height={settings.size}"]
        run = partial(
            subprocess.run, words, cwd=folder, env=timing.environment(), capture_output=True
        )
        starts = 1 if settings.quick else 5
        took = timing.repeated(lambda: run(check=True), starts)
    row = {"subject": f"imagechain run {timing.KODAK}", "value": took["seconds"], "unit": "s"}
    row |= {"low": took["low"], "high": took["high"], **judged(took["seconds"], 1.2, 0.6)}
    heads = {n: h for n, h in HEADS.items() if not n.endswith("ms")}
    heads |= {"low": "minimum", "high": "maximum"}
    title = f"Fresh process, {settings.size}², median of {several(starts, 'start')}"
    text = "Starting Python, drawing the scene and writing the files are included."
    return [Table("fresh_process", title, heads, [row], text)]


def whole_chain(scene: Array, lines: int, samples: int, seed: int) -> Array:
    """The Kodak chain as a plain program of 1996 has it, without photon noise: the baseline."""
    picture = plain_optics(scene)
    draw = np.random.default_rng(seed).standard_normal
    mean = picture.mean()
    picture = picture * (1.0 + 0.01 * draw(picture.shape))  # gain and bias of each detector
    picture = picture + 0.01 * mean * draw(picture.shape)
    picture = picture + 1e-4 * draw(picture.shape)  # the detector's noise, W m⁻² sr⁻¹
    picture = picture + mean / 100.0 * draw(picture.shape)  # the amplifier's
    low, high = picture.min(), picture.max()
    step = (high - low) / (2**6 - 1)
    return _grabbed(np.asarray(low + step * np.round((picture - low) / step)), lines, samples)


def plain_optics(scene: Array) -> Array:
    rows, columns = scene.shape
    interval_x, interval_y = (np.radians(25.0) * 1000.0 / count for count in (columns, rows))
    xi, eta = np.meshgrid(np.fft.fftfreq(columns, interval_x), np.fft.fftfreq(rows, interval_y))
    spectrum = np.fft.fft2(scene)
    magnitude, phase = np.abs(spectrum), np.angle(spectrum)

    v = np.minimum(np.hypot(xi, eta) * 4.0 / 90.0, 1.0)  # µm over mm (Goodman 2005, eq. 6-32)
    magnitude = magnitude * (2.0 / np.pi * (np.arccos(v) - v * np.sqrt(1.0 - v**2)))
    magnitude = magnitude * np.exp(-2.0 * np.pi**2 * 0.1**2 * (xi**2 + eta**2))
    pixel_mrad = 25.0 / 200.0 * 0.95  # pitch in µm over focal length in mm, times the fill factor
    magnitude = magnitude * np.sinc(pixel_mrad * xi) * np.sinc(pixel_mrad * eta)
    lost = 1.0 - 0.99999  # of a charge transfer
    one = (1.0 - lost) / (1.0 - lost * np.exp(-2j * np.pi * interval_x * xi))
    transfer = one**640
    magnitude = magnitude * np.abs(transfer)
    phase = phase + np.angle(transfer)

    picture = np.real(np.fft.ifft2(magnitude * np.exp(1j * phase)))
    blocks = picture.reshape(rows // 2, 2, columns // 2, 2)
    return np.asarray(blocks.mean(axis=(1, 3)))


def _grabbed(picture: Array, lines: int, samples: int) -> Array:
    rows, columns = picture.shape
    y = np.clip((np.arange(lines) + 0.5) * rows / lines - 0.5, 0, rows - 1)
    x = np.clip((np.arange(samples) + 0.5) * columns / samples - 0.5, 0, columns - 1)
    top, left = np.floor(y).astype(int), np.floor(x).astype(int)
    below, right = np.minimum(top + 1, rows - 1), np.minimum(left + 1, columns - 1)
    down, across = (y - top)[:, np.newaxis], x - left
    upper = picture[top][:, left] * (1 - across) + picture[top][:, right] * across
    lower = picture[below][:, left] * (1 - across) + picture[below][:, right] * across
    return np.asarray(upper * (1 - down) + lower * down)


MEASURES = (networks, one_thread, fresh_process)
