"""The same optical work done by other programs, where they are installed.

A circular aperture and a square pixel blur a frame; its sampling is that of pyBSM's documentation,
a quarter of the cutoff's period. The delivered MTF is the FFT of a unit point sent through the
whole path, and its error the largest difference from the analytic product.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from importlib import metadata
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table
from app.bench.measuring.timing import paired, round_trip, seconds
from app.bench.peers.cameras_compared import cameras
from app.bench.peers.peer_imports import why_missing
from app.bench.peers.peer_programs import PEERS, Task
from app.bench.peers.peer_self import OURS
from app.bench.truth.truth_pictures import Sensor
from app.options.command_options import version

Array = NDArray[Any]


def peers(settings: Settings) -> list[Table]:
    """Time and delivered error of each program, and what is not installed."""
    sizes = (settings.size // 2,) if settings.quick else (settings.size // 2, settings.size)
    rows: list[dict[str, Any]] = []
    for size in sizes:
        task = Task(size)
        expected = _analytic(task)
        scene = np.random.default_rng(3).uniform(20, 60, (size, size)).astype(np.float32)
        for name, build in OURS:
            row = _measured(name, size, partial(build, task), scene, expected, settings)
            rows.append(row | {"maker": "imagechain", "version": version()})
        for package, name, build in PEERS:
            missing = why_missing(package)
            if missing:
                rows.append({"program": name, "size": size, "note": missing})
                continue
            row = _measured(name, size, partial(build, task), scene, expected, settings)
            rows.append(row | {"maker": package, "version": metadata.version(package)})
    heads = {
        "program": "program",
        "version": "version",
        "size": "size",
        "t0": "T0",
        "ms": "ms",
        "error": "delivered MTF error",
        "shift": "shift, samples",
        "note": "",
    }
    title = "Circular aperture and square pixel: the frame filtered"
    text = (
        "T0 is the round trip of the frame in single precision for every row. `known`: the "
        "transfer function or PSF is there already and only the frame is new. `mirrored`: tails of "
        "the point's image come back from the edges, which the FFT takes for an error. Extra "
        "`peers` installs the other programs."
    )
    chart = Chart(
        "t0",
        "error",
        "time (T0, the bare Fourier round trip of the frame)",
        "largest error of the delivered MTF",
        "program",
        "maker",
        title=f"Aperture and pixel: error of the delivered MTF against time, {sizes[-1]}²",
        where=("size", sizes[-1]),
        by_colour=True,
    )
    return [
        Table("peers", title, heads, tuple(rows), text, chart, tuple(heads), ("size", sizes[-1]))
    ]


def _measured(
    name: str,
    size: int,
    build: Callable[[], Callable[[Array], Array]],
    scene: Array,
    expected: Array,
    settings: Settings,
) -> dict[str, Any]:
    row: dict[str, Any] = {"program": name, "size": size}
    try:
        deliver = build()
        timing = paired(
            lambda: seconds(lambda: deliver(scene)),
            round_trip(scene, settings.threads),
            pairs=settings.slow_pairs,
            warm_up=1,
        )
        point = np.zeros((size, size), np.float32)
        point[size // 2, size // 2] = 1
        response = np.fft.fft2(np.asarray(deliver(point), np.float64)) / np.fft.fft2(point)
    except Exception as error:  # another program's failure is a row of the table, not ours
        return row | {"note": f"failed: {type(error).__name__}: {error}"[:120]}
    wrong = float(np.abs(np.abs(response) - np.abs(expected)).max())
    shift = -float(np.angle(response[0, 1])) * size / (2 * np.pi)
    note = getattr(deliver, "note", "")
    return row | timing.facts() | {"error": wrong, "shift": shift, "note": note}


def _analytic(task: Task) -> Array:
    frequency = np.fft.fftfreq(task.size, task.interval_mrad).astype(np.longdouble)
    sensor = Sensor(
        task.interval_mrad,
        aperture_mm=task.aperture_mm,
        wavelength_um=task.wavelength_um,
        aberration_mrad=0.0,
        pixel_mrad=task.pixel_mrad,
    )
    modulus = sensor.modulus(frequency[np.newaxis, :], frequency[:, np.newaxis])
    return np.asarray(modulus, np.float64)


MEASURES = (peers, cameras)
