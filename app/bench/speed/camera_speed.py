"""Speed of a camera in electrons, and of edits of it, in T0."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Table, verdict
from app.bench.measuring.camera_chain import CAMERA, OPTICS, Camera
from app.bench.measuring.timing import paired, round_trip

_HEADS = {
    "subject": "subject",
    "threads": "threads",
    "t0": "T0",
    "low": "25 %",
    "high": "75 %",
    "ms": "ms",
    "t0_ms": "T0 ms",
    "reach": "reach",
    "aim": "aim",
    "verdict": "",
}
_READ_NOISES = tuple(100.0 + step for step in range(1, 32))
_TIMES = tuple(1e-3 + 1e-5 * step for step in range(1, 32))
_BITS = (10, 11, 12, 13)


def cameras(settings: Settings) -> list[Table]:
    """A focal plane with every noise on behind its optics; edits with unit deviates at hand."""
    rows = []
    for threads in (0, 1):
        camera = Camera(settings.size, threads)
        t0 = round_trip(camera.scene, camera.policy.workers)
        behind_optics, whole = camera.kept(OPTICS), camera.kept(CAMERA)
        subjects: tuple[tuple[str, Callable[[], float], float | None, float | None], ...] = (
            ("optics and camera", partial(camera.cold, camera.network, CAMERA), None, None),
            (
                "camera alone, every noise",
                _after(camera, OPTICS, behind_optics, "", ()),
                4.0,
                2.0,
            ),
            (
                "edit of the read noise",
                _after(camera, CAMERA, whole, "read_noise_e", _READ_NOISES),
                0.5,
                None,
            ),
            (
                "edit of the integration time",
                _after(camera, CAMERA, whole, "integration_time_s", _TIMES),
                None,
                None,
            ),
            ("edit of the bits", _after(camera, CAMERA, whole, "bits", _BITS), 0.5, 0.25),
        )
        for name, subject, reach, aim in subjects:
            timing = paired(subject, t0, pairs=settings.pairs)
            rows.append(
                {
                    "subject": name,
                    "threads": camera.policy.workers,
                    **timing.facts(),
                    "reach": reach,
                    "aim": aim,
                    "verdict": verdict(timing.ratio, reach, aim),
                }
            )
    title = f"A camera in electrons, {settings.size}², single precision"
    text = (
        "Shot and read noise, PRNU, DSNU, a bent response, bad pixels, 14 bits. Alone: the picture "
        "behind the optics is known, and nothing of the camera. Four normal deviates a pixel are "
        "half of it; unit deviates are values of their own, so that an edit draws none."
    )
    return [Table("cameras", title, _HEADS, tuple(rows), text, brief=tuple(_HEADS))]


def _after(
    camera: Camera, port: str, known: set[str], parameter: str, values: tuple[float, ...]
) -> Callable[[], float]:
    """A subject that begins with what a port leaves; it is made again where it has gone."""

    def subject() -> float:
        if not known <= camera.store.keys():
            known.clear()
            known.update(camera.kept(port))
        return camera.behind(known, parameter, values)

    return subject
