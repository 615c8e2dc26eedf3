"""Details of precision: planes of pupil OTFs, quantiles of Poisson counts, convolution in space."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import special

from app.bench.chains import Chain, Kodak, sensor_network
from app.bench.precision import Otf, pupil_network
from app.bench.tables import T0_HEADS, Chart, Table
from app.bench.timing import Settings, paired, round_trip
from app.bench.truth import Sensor, mirrored_frame, poisson_cumulative
from core.evaluation.policy import Policy
from core.network.network import Link, Network, Node
from core.physics.noise.poisson import poisson_of_normal

Array = NDArray[Any]
SPACE, FOURIER = "space.image", "back.image"
SHAPES = {
    "clear": {},
    "half_moon": {},
    "cassegrain": {"obscuration_radius": 60},
    "hinged": {"slit_width": 20},
    "cassegrain_slit": {"obscuration_radius": 60, "slit_width": 20},
    "spider": {"obscuration_radius": 60, "vanes": 4, "vane_width": 4},
}  # as parts of an array of 512
MEANS = (0.3, 3.0, 15.9, 16.0, 40.0, 64.0, 200.0, 1e3, 1e4, 1e5)
INTERVAL_MRAD, WAVELENGTH_UM = 1.0, 10.0
BLUR: dict[str, Any] = {"aberration_mrad": 0.5, "pixel_mrad": 1.0, "transfers": 0}
# An aperture without end has no transfer function of its own: what is left separates.
APERTURES_MM = {"two passes": math.inf, "a plane": 20.0}
HALF_WIDTHS = {"two passes": (1, 2, 4, 8, 16, 64), "a plane": (1, 2, 4, 8, 16)}


def low_rank(settings: Settings) -> list[Table]:
    """Planes from tables, thin matrices and the support, against the closed form everywhere."""
    kodak = Kodak(settings.small)
    t0 = round_trip(kodak.scene, kodak.policy.workers)
    rows = []
    for shape, lengths in SHAPES.items():
        network = pupil_network(kodak.network, shape, 512)
        for name, value in lengths.items():
            network = network.with_parameter("pupil", name, value)
        otf = Otf(kodak, network)
        planes = otf.planes()
        starts = range(0, otf.grid.rows, 64)
        plane = np.concatenate([np.asarray(planes.block(slice(n, n + 64))) for n in starts])
        xi, eta = otf.grid.xi_mirrored(), otf.grid.eta_mirrored()
        direct = otf.factor.transfer(kodak.work, xi[np.newaxis, :], eta[:, np.newaxis])
        known = partial(otf.of_blocks, planes.block, known=True)
        subjects = {"direct": otf.direct, "plane": otf.plane, "plane, known": known}
        for choice, subject in subjects.items():
            error = 0.0 if choice == "direct" else float(np.abs(plane - direct).max())
            timing = paired(subject, t0, pairs=settings.slow_pairs, warm_up=1)
            row = {"shape": shape, "choice": choice, **timing, "error": error}
            rows.append(row | {"mark": choice if shape == "clear" else None})
    heads = {"shape": "pupil", "choice": "OTF plane", **T0_HEADS}
    heads["error"] = "difference from the closed form"
    text = (
        "Single precision, whose rounding covers these errors. The default plane of a disc or an "
        "annulus comes from a table of the radius, and for large pictures from two thin matrices; "
        "those of other pupils are in closed form, and so is every plane in double precision. "
        "Nothing is evaluated beyond the cutoff. A plane is kept (known)."
    )
    title = f"Planes of pupil OTFs, {settings.small}² frequencies"
    chart = Chart("difference from the closed form", "mark", "shape")
    return [Table("low_rank", title, heads, rows, text, chart)]


def quantiles(_settings: Settings) -> list[Table]:
    """How far the quantile of a normal deviate is from Poisson's, without drawing any."""
    rows = []
    for mean in MEANS:
        count, chance = _chances(mean)
        law = np.diff(poisson_cumulative(mean), prepend=0.0)
        exact = np.zeros(max(len(law), len(chance)))
        exact[: len(law)] = law
        exact[: len(chance)] -= chance
        first = float(chance @ count)
        second = float(chance @ (count - first) ** 2)
        third = float(chance @ (count - first) ** 3)
        rows.append(
            {
                "mean": mean,
                "distance": 0.5 * float(np.abs(exact).sum()),
                "mean_error": first / mean - 1.0,
                "variance": second / mean - 1.0,
                "skewness": third / second**1.5 * math.sqrt(mean) - 1.0,
            }
        )
    heads = {
        "mean": "mean",
        "distance": "total variation distance",
        "mean_error": "mean, relative error",
        "variance": "variance, relative error",
        "skewness": "skewness, relative error",
    }
    text = (
        "Shot noise of a focal plane is the quantile of Poisson's distribution at a unit normal "
        "deviate: below a mean of 16 it is summed, from there expanded (Giles 2016) to 1/mean, "
        "from 64 on to 1/√mean. A test of n samples sees a distance from about 1/√n on: one of "
        "1e-5 takes 1e10 samples."
    )
    title = "Poisson counts of normal deviates, against the exact distribution"
    return [Table("poisson_quantile", title, heads, rows, text)]


def _chances(mean: float) -> tuple[Array, Array]:
    """Counts, and how probable a normal deviate makes them: where the count steps, by halving."""
    count = np.arange(0.0, mean + 8.0 * math.sqrt(mean) + 12.0)
    low, high = np.full(count.size, -9.0), np.full(count.size, 9.0)
    means = np.full(count.size, mean)
    for _ in range(70):
        middle = (low + high) / 2.0
        below = poisson_of_normal(means, middle) < count
        low, high = np.where(below, middle, low), np.where(below, high, middle)
    return count, np.diff(np.append(special.ndtr(low), 1.0))


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
                    **paired(subject, t0, pairs=pairs, warm_up=1),
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
    chart = Chart("largest error / max", "choice", "kernel")
    return [Table("spatial", title, heads, rows, _text(rows), chart)]


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
    scene = {"kind": "dormitory", "width": size, "height": size}
    pitch = {"detector_x_um": 1e3, "detector_y_um": 1e3, "focal_length_mm": 1e3}
    sigma = BLUR["aberration_mrad"]
    stages = {
        "aberration": ("gaussian_mtf", {"sigma_x_mrad": sigma, "sigma_y_mrad": sigma}),
        "pixel": ("detector_mtf", {}),
    }
    disc = (aperture_mm, WAVELENGTH_UM) if math.isfinite(aperture_mm) else None
    fields = {"fov_x_deg": field, "fov_y_deg": field}
    network = sensor_network(("test_scene", {**scene, **fields}), pitch, stages, disc=disc)
    space = (("init.phase", "space.phase"), ("pixel.magnitude", "space.magnitude"))
    links = (*network.links, *(Link.between(*link) for link in space))
    return Network(nodes={**network.nodes, "space": Node("space", "spatial_blur")}, links=links)


MEASURES = (low_rank, quantiles, spatial)
