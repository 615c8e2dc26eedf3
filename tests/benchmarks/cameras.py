"""Speed of a camera of today, and of its frames, in T0."""

import tempfile
from functools import partial
from pathlib import Path
from typing import Any

from app.bench.speed import SNRS, TARGETS, Subject, timed
from app.bench.tables import Table, judged
from app.bench.timing import Chain, Nodes, Settings, repeated, sensor_network
from app.run.saving import save_frames
from core.evaluation.work import Policy
from nodes.files.frames import FRAME_FORMATS

OPTICS, CAMERA = "back.image", "camera.image"
TIMES = tuple(1e-3 + 1e-5 * step for step in range(1, 32))
COLUMNS, ROWS = 640, 512  # of the usual cooled camera
_FOCAL_PLANE = {
    "integration_time_s": 0.004, "optics_transmission": 0.8, "optics_K": 293.0,
    "dark_current_e_per_s": 1e5, "full_well_e": 7e6, "nonlinearity_percent": 1.0,
    "read_noise_e": 400.0, "prnu_percent": 0.3, "dsnu_e": 200.0, "bad_pixel_percent": 0.3,
    "bits": 14,
}  # fmt: skip


class Camera(Chain):
    """A cooled camera of today on a scene of `size` by `rows`, with every noise of its plane."""

    def __init__(self, size: int, threads: int = 0, rows: int | None = None) -> None:
        rows = size if rows is None else rows
        scene = {
            "kind": "dormitory", "width": size, "height": rows, "fov_x_deg": 8.8,
            "fov_y_deg": 8.8 * rows / size, "cut_on_um": 3.7, "cut_off_um": 4.8,
        }  # fmt: skip
        sensor = {
            "detector_x_um": 15.0, "detector_y_um": 15.0, "focal_length_mm": 100.0,
            "f_number": 4.0, "platform": "array",
        }  # fmt: skip
        stages: Nodes = {
            "detector": ("detector_mtf", {}),
            "jitter": ("jitter_mtf", {"sigma_mrad": 0.05}),
        }
        plane: Nodes = {"camera": ("focal_plane", _FOCAL_PLANE)}
        network = sensor_network(("test_scene", scene), sensor, stages, plane)
        super().__init__(network, Policy("single", threads=threads))


def cameras(settings: Settings) -> list[Table]:
    """A focal plane with every noise on behind its optics; edits with unit deviates at hand."""
    rows = []
    for threads in (0, 1):
        camera = Camera(settings.size, threads)
        optics, whole = camera.left_by(OPTICS), camera.left_by(CAMERA)
        edited = partial(_after, camera, CAMERA, whole)
        noises = ("camera", "read_noise_e", SNRS)
        times = ("camera", "integration_time_s", TIMES)
        bits = ("camera", "bits", (10, 11, 12, 13))
        cold = partial(camera.cold, camera.network, CAMERA)
        subjects: list[Subject] = [
            ("optics and camera", cold, None, None),
            ("camera alone, all noise", partial(_after, camera, OPTICS, optics), 4.0, 2.0),
            ("edit of the read noise", partial(edited, noises), 0.5, None),
            ("edit of the integration time", partial(edited, times), None, None),
            ("edit of the number of bits", partial(edited, bits), 0.5, 0.25),
        ]
        rows += [row | {"t0": row["value"]} for row in timed(camera, subjects, settings)]
    heads = {"subject": "subject", "threads": "threads", "t0": "T0", "low": "25 %"}
    heads |= {"high": "75 %", "ms": "ms", "t0_ms": "T0 ms", **TARGETS}
    title = f"A camera in electrons, {settings.size}², single precision"
    text = (
        "Shot and read noise, PRNU, DSNU, a nonlinear response, bad pixels, 14 bits. `alone`: "
        "only the picture after the optics has been computed. Half of the time goes into "
        "four normal deviates per pixel; they are stored, so an edit does not draw them again."
    )
    return [Table("cameras", title, heads, rows, text)]


def _after(camera: Camera, port: str, known: set[str], edit: Any = None) -> float:
    """Seconds to the picture behind what a port leaves, which is made again where it has gone."""
    if not known <= camera.store.keys():
        known.clear()
        known.update(camera.left_by(port))
    return camera.edited(CAMERA, known, edit)


def frames(settings: Settings) -> list[Table]:
    columns, lines = min(COLUMNS, settings.size), min(ROWS, settings.size)
    count = 10 if settings.quick else 100
    rows = []
    for threads in (0, 1):
        camera = Camera(columns, threads, lines)
        image = camera.engine.plan(camera.network).output(CAMERA)
        for kind in FRAME_FORMATS:
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / f"frames{kind.suffixes[0]}"
                camera.value(camera.network, CAMERA)
                save = partial(save_frames, image, path, camera.work, port=CAMERA, frames=count)
                took = repeated(save, settings.slow_pairs)
                megabytes = 1e-6 * path.stat().st_size / count
            middle = 1e3 * took["seconds"] / count
            row = {"subject": kind.description, "threads": camera.policy.workers}
            row |= {"rate": 1e3 / middle, "low": count / took["high"], "high": count / took["low"]}
            row |= {"ms": middle, "megabytes": megabytes, **judged(middle, 1e3 / 60, 1e3 / 120)}
            rows.append(row)
    heads = {"subject": "written as", "threads": "threads", "rate": "frames per second"}
    heads |= {"low": "least", "high": "most", "ms": "ms per frame", "megabytes": "MB per frame"}
    heads |= {"reach": "limit, ms", "aim": "target, ms", "verdict": ""}
    title = f"Frames of a camera, {columns} × {lines}, single precision"
    text = (
        f"The camera above, {count} frames to a file in the temporary folder, flushed to its "
        "disk. The noise-free picture is computed once for all frames. Each frame has new "
        "shot and read noise, and the same fixed patterns and bad pixels. The limit is 60 "
        "frames a second, the target 120."
    )
    return [Table("frames", title, heads, rows, text)]


MEASURES = (cameras, frames)
