"""Frames a second of a camera, made and written to files."""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Table, verdict
from app.bench.measuring.camera_chain import CAMERA, Camera
from app.run.sequence import save_frames
from nodes.files.frames.frame_writing import FRAME_FORMATS

_HEADS = {
    "subject": "written as",
    "threads": "threads",
    "rate": "frames a second",
    "low": "least",
    "high": "most",
    "ms": "ms a frame",
    "megabytes": "MB a frame",
    "reach": "ms, reach",
    "aim": "ms, aim",
    "verdict": "",
}
_COLUMNS, _ROWS = 640, 512  # of the usual cooled camera
_REACH_MS, _AIM_MS = 1000.0 / 60.0, 1000.0 / 120.0


def frames(settings: Settings) -> list[Table]:
    """Frames of a focal plane with every noise on, its picture before the noise known."""
    columns, rows = min(_COLUMNS, settings.size), min(_ROWS, settings.size)
    count = 10 if settings.quick else 100
    made = []
    for threads in (0, 1):
        camera = Camera(columns, threads, rows)
        plan = camera.engine.plan(camera.network)
        image = plan.output(CAMERA)
        for kind in FRAME_FORMATS:
            took = []
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / f"frames{kind.suffixes[0]}"
                camera.value(camera.network, CAMERA)
                for _ in range(settings.slow_pairs):
                    start = time.perf_counter()
                    save_frames(image, path, camera.work, port=CAMERA, frames=count)
                    took.append((time.perf_counter() - start) / count)
                size = path.stat().st_size / count
            middle = 1e3 * statistics.median(took)
            made.append(
                {
                    "subject": kind.description,
                    "threads": camera.policy.workers,
                    "rate": 1e3 / middle,
                    "low": 1.0 / max(took),
                    "high": 1.0 / min(took),
                    "ms": middle,
                    "megabytes": 1e-6 * size,
                    "reach": _REACH_MS,
                    "aim": _AIM_MS,
                    "verdict": verdict(middle, _REACH_MS, _AIM_MS),
                }
            )
    title = f"Frames of a camera, {columns} × {rows}, single precision"
    text = (
        f"The camera above, {count} frames to a file of the temporary folder, flushed to its disk; "
        "the picture that the noise is drawn on is known, and is made once for all frames. A frame "
        "draws shot and read noise anew, and shares the fixed patterns and bad pixels. Reach is 60 "
        "frames a second, aim 120."
    )
    return [Table("frames", title, _HEADS, tuple(made), text, brief=tuple(_HEADS))]
