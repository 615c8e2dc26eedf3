"""The choice of how a line scanner's mixed sampling is treated: at one scale, or line by line.

Scan lines are equally far apart on the ground, and so closer together in angle where the scanner
looks aslant. A whole frame is filtered at one scale, as in 1996; or each line in flight at its own:
what separates exactly, what does not blended from a few scales, or summed directly for every one.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.tables import T0_HEADS, Chart, Table
from app.bench.timing import Chain, Settings, paired, round_trip, seconds, sensor_network
from app.bench.truth import Sensor, cosine_spectrum, cosines_and_sines
from core.evaluation.work import Policy, Precision
from core.network.network import Link, Network, Node

Array = NDArray[Any]
FIELDS_DEG = (30.0, 80.0)  # the thesis' line scanner, and a wide one for survey from the air
# The thesis' line scanner: 75 mm at 10 µm, and 600 µm over 130 mm times the fill factor.
SENSOR: dict[str, Any] = {"aperture_mm": 75.0, "wavelength_um": 10.0, "aberration_mrad": 0.5}
PITCH_UM, FOCAL_LENGTH_MM, FILL = 600.0, 130.0, 0.95
ALTITUDE_M = 402.0
COUNTS = (1, 2, 3, 4)
COLUMNS_CHECKED = 16
LARGEST = 512  # direct sums take a plane of the transfer function for every line
WHOLE, LINES = "whole image", "lines.image"


@dataclass(frozen=True)
class Scanner:
    """A scan of a field of view, its lines as far apart at nadir as its samples.

    Without its round aperture the transfer function separates.
    """

    size: int
    field_deg: float
    aperture: bool = True
    precision: Precision = "single"

    @cached_property
    def chain(self) -> Chain:
        """The network, its scene in memory."""
        network = _network(self.size, self.field_deg, self.aperture)
        return Chain(network, Policy(precision=self.precision))

    @property
    def interval_mrad(self) -> float:
        """Angle between the samples of a scan line, and between scan lines at nadir."""
        return math.radians(self.field_deg) * 1000.0 / self.size

    @property
    def name(self) -> str:
        """For people."""
        return f"{self.field_deg:g}°" + ("" if self.aperture else ", separable")

    def whole(self) -> Array:
        """The whole frame filtered, scan lines as far apart everywhere as at nadir."""
        return np.asarray(self.chain.value(self.chain.network, "back.image"))

    def line_by_line(self, method: str = "nodes", nodes: int | None = None) -> Array:
        """Each line in flight at its own scale."""
        network = self.chain.network.with_parameter("lines", "method", method)
        if nodes is not None:
            network = network.with_parameter("lines", "nodes", nodes)
        return np.asarray(self.chain.value(network, LINES))

    def expected(self) -> tuple[Array, Array]:
        """Some columns and what they have to be."""
        columns = np.unique(np.linspace(0, self.size - 1, COLUMNS_CHECKED).round().astype(int))
        pixel_mrad = PITCH_UM / FOCAL_LENGTH_MM * FILL
        settings = SENSOR if self.aperture else {**SENSOR, "wavelength_um": 0.0}  # no diffraction
        sensor = Sensor(self.interval_mrad, **settings, pixel_mrad=pixel_mrad, transfers=0)
        spectrum = cosine_spectrum(self.chain.scene)
        # The interval from the triangle, not from the measured geometry's cosine.
        aside = np.tan((columns - 0.5 * (self.size - 1)) * self.interval_mrad * 1e-3)
        own = self.interval_mrad / np.hypot(1.0, aside)
        values = [
            mirrored_column(spectrum, sensor, column, float(interval))
            for column, interval in zip(columns, own, strict=True)
        ]
        return columns, np.array(values).T


def scanning(settings: Settings) -> list[Table]:
    """Whole image and line by line for two fields of view, and for a chain that separates."""
    size = min(settings.small, LARGEST)
    rows: list[dict[str, Any]] = []
    for scanner in (*(Scanner(size, field) for field in FIELDS_DEG), Scanner(size, 80.0, False)):
        columns, expected = scanner.expected()
        t0 = round_trip(scanner.chain.scene, scanner.chain.policy.workers)
        for choice, subject, pairs in _subjects(scanner, settings):
            picture = subject()[:, columns]
            facts = paired(partial(_cold, scanner, subject), t0, pairs=pairs, warm_up=1)
            error = float(np.abs(picture - expected).max() / np.abs(expected).max())
            rows.append({"field": scanner.name, "choice": choice, **facts, "error": error})
    heads = {"field": "field of view", "choice": "treatment", **T0_HEADS}
    heads["error"] = "largest error / max"
    text = _text(rows)
    title = f"Line scanner: whole image against line by line, {size}², single precision"
    chart = Chart("largest error / max", "choice", "field")
    return [Table("scanning", title, heads, rows, text, chart)]


def _subjects(scanner: Scanner, settings: Settings) -> list[tuple[str, Callable[[], Array], int]]:
    whole = (WHOLE, scanner.whole, settings.pairs)
    if not scanner.aperture:
        return [whole, ("line by line", scanner.line_by_line, settings.pairs)]
    blends = [
        (
            f"{count} scale{'s' if count > 1 else ''}",
            partial(scanner.line_by_line, nodes=count),
            settings.slow_pairs,
        )
        for count in COUNTS
    ]
    direct = partial(scanner.line_by_line, "direct")
    return [whole, *blends, ("direct sums", direct, settings.slow_pairs)]


def _cold(scanner: Scanner, subject: Callable[[], Array]) -> float:
    scanner.chain.store.clear()
    return seconds(subject)


def _text(rows: list[dict[str, Any]]) -> str:
    whole = {row["field"]: row for row in rows if row["choice"] == WHOLE}

    def slower(choice: str) -> str:
        ratios = [row["t0"] / whole[row["field"]]["t0"] for row in rows if row["choice"] == choice]
        return f"{float(f'{max(ratios):.2g}'):g}"

    errors = " and ".join(
        f"{row['error']:.1%} at {field}" for field, row in whole.items() if "," not in field
    )
    return (
        "Default whole image at nadir's scale, as in 1996: one transform serves, and what errs is "
        f"the width of the blur towards the ends of the scan (by {errors} of the largest value). "
        f"Line by line, what separates is exact, for {slower('line by line')} times the whole "
        "image's time. An aperture at two or three scales, blended column by column, comes down to "
        f"single precision's rounding for {slower('3 scales')} times, the estimate of its error "
        f"included; direct sums take {slower('direct sums')} times as long."
    )


def _network(size: int, field_deg: float, aperture: bool) -> Network:
    sigma = SENSOR["aberration_mrad"]
    scene = {"kind": "dormitory", "width": size, "height": size}
    init = {
        "focal_length_mm": FOCAL_LENGTH_MM, "detector_x_um": PITCH_UM, "detector_y_um": PITCH_UM,
        "fill_x": FILL, "fill_y": FILL, "range_m": ALTITUDE_M,
    }  # fmt: skip
    stages = {
        "aberration": ("gaussian_mtf", {"sigma_x_mrad": sigma, "sigma_y_mrad": sigma}),
        "pixel": ("detector_mtf", {}),
    }
    disc = (SENSOR["aperture_mm"], SENSOR["wavelength_um"]) if aperture else None
    fields = {"fov_x_deg": field_deg, "fov_y_deg": field_deg}
    network = sensor_network(("test_scene", {**scene, **fields}), init, stages, disc=disc)
    lines = [("pixel.magnitude", "lines.magnitude"), ("init.phase", "lines.phase")]
    lines.append(("init.context", "lines.context"))
    links = (*network.links, *(Link.between(*link) for link in lines))
    nodes = {**network.nodes, "lines": Node("lines", "line_by_line")}
    return replace(network, nodes=nodes, links=links)


def mirrored_column(
    spectrum: Array, sensor: Sensor, column: int, interval_in_flight_mrad: float
) -> Array:
    """One column of the mirrored frame, its samples that far apart along it.

    `spectrum` is the scene's from `cosine_spectrum`; the sensor's interval holds across.
    """
    size = len(spectrum)
    number = np.arange(size, dtype=np.longdouble)
    xi = number / (2 * size * sensor.interval_mrad)
    eta = number / (2 * size * np.longdouble(interval_in_flight_mrad))
    transfer = np.asarray(sensor.modulus(xi[np.newaxis, :], eta[:, np.newaxis]), np.float64)
    cosine, _ = cosines_and_sines(size)
    return np.asarray(cosine @ ((spectrum * transfer) @ cosine[column]))


MEASURES = (scanning,)
