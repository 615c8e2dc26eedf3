"""The choice of multiplying the spectrum, or of convolving in space with kernels cut short."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table
from app.bench.measuring.loaded_network import SCENE, Chain, network_of, stages_in_turn
from app.bench.measuring.timing import paired, round_trip
from app.bench.truth.truth_pictures import Sensor, mirrored_frame
from core.evaluation.policy import Policy
from core.network.network import Network

INTERVAL_MRAD = 1.0
BLUR: dict[str, Any] = {"aberration_mrad": 0.5, "pixel_mrad": 1.0, "transfers": 0}
# An aperture without end has no transfer function of its own: what is left separates.
APERTURES_MM = {"two passes": math.inf, "a plane": 20.0}
WAVELENGTH_UM = 10.0
HALF_WIDTHS = {"two passes": (1, 2, 4, 8, 16, 64), "a plane": (1, 2, 4, 8, 16)}
SPACE, FOURIER = "space.image", "back.image"


def spatial(settings: Settings) -> list[Table]:
    """Kernels of several half widths and the Fourier way, against a direct sum."""
    size = settings.small
    rows: list[dict[str, Any]] = []
    for kernel, aperture_mm in APERTURES_MM.items():
        network = spatial_network(size, aperture_mm)
        chain = Chain(network, Policy())
        sensor = Sensor(INTERVAL_MRAD, aperture_mm=aperture_mm, wavelength_um=WAVELENGTH_UM, **BLUR)
        expected = mirrored_frame(chain.scene, sensor)
        t0 = round_trip(chain.scene, chain.policy.workers)
        for half_width in (None, *HALF_WIDTHS[kernel]):
            port, pairs = FOURIER, settings.pairs
            if half_width is not None:
                network = network.with_parameter("space", "half_width_px", half_width)
                port, pairs = SPACE, settings.slow_pairs
            picture = chain.value(network, port)
            subject = partial(chain.cold, network, port)
            rows.append(
                {
                    "kernel": kernel,
                    "choice": "Fourier" if half_width is None else f"±{half_width}",
                    **paired(subject, t0, pairs=pairs, warm_up=1).facts(),
                    "error": float(np.abs(picture - expected).max() / np.abs(expected).max()),
                }
            )
    heads = {
        "kernel": "kernel",
        "choice": "half width, samples",
        "t0": "T0",
        "ms": "ms",
        "error": "largest error / max",
    }
    title = f"Convolution in space against the Fourier way, {size}², single precision, mirrored"
    chart = Chart("t0", "error", "time (T0)", "largest error / max", "choice", "kernel", lines=True)
    return [Table("spatial", title, heads, tuple(rows), _text(rows), chart)]


def _text(rows: list[dict[str, Any]]) -> str:
    clauses = []
    for kernel in APERTURES_MM:
        fourier, *space = (row for row in rows if row["kernel"] == kernel)
        faster = [row for row in space if row["ms"] < fourier["ms"]]
        if faster:
            last = faster[-1]
            up_to = f"is faster here up to {last['choice']} samples, where it errs by"
            clauses.append(f"in {kernel} it {up_to} {last['error']:.1g} of the largest value")
        else:
            clauses.append(f"in {kernel} it is the slower here at every width")
    return (
        "Default Fourier: its time does not depend on the blur, and it is exact. Convolution in "
        f"space is there to compare with: {'; '.join(clauses)}. The kernel is made anew each time."
    )


def spatial_network(size: int, aperture_mm: float) -> Network:
    """Pupil (unless without end), aberration and pixel, delivered by both ways."""
    field = math.degrees(INTERVAL_MRAD * 1e-3 * size)
    fields = {"fov_x_deg": field, "fov_y_deg": field}
    pitch = {"detector_x_um": 1e3, "detector_y_um": 1e3, "focal_length_mm": 1e3}
    sigma = BLUR["aberration_mrad"]
    nodes: dict[str, tuple[str, dict[str, Any]]] = {
        "scene": ("test_scene", {"kind": "dormitory", "width": size, "height": size, **fields}),
        "init": ("init_trans", pitch),
        "aberration": ("gaussian_mtf", {"sigma_x_mrad": sigma, "sigma_y_mrad": sigma}),
        "pixel": ("detector_mtf", {}),
        "back": ("back_transform", {}),
        "space": ("spatial_blur", {}),
    }
    links = [(SCENE, "init.image"), ("init.phase", "space.phase")]
    links += [("pixel.magnitude", "space.magnitude")]
    stages = ["aberration", "pixel"]
    if math.isfinite(aperture_mm):
        across = {"size_x_cm": 0.2 * aperture_mm, "size_y_cm": 0.2 * aperture_mm}
        band = {"cut_on_um": WAVELENGTH_UM, "cut_off_um": WAVELENGTH_UM}
        nodes["pupil"] = ("exit_pupil", {"size_x": 512, "size_y": 512, "radius": 128.0})
        nodes["optics"] = ("exit_pupil_mtf", {**band, **across})
        links += [("pupil.pupil", "optics.pupil"), ("init.phase", "optics.phase")]
        stages.insert(0, "optics")
    return network_of(nodes, [*links, *stages_in_turn(stages)])


MEASURES = (spatial,)
