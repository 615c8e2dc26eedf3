"""The choice of how a line scanner's mixed sampling is treated: at one scale, or line by line.

Scan lines are equally far apart on the ground, and so closer together in angle where the scanner
looks aslant. A whole frame is filtered at one scale, as in 1996; several frames at scales between
are blended; or each line in flight is filtered at its own, by a direct sum.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.chain import SCENE, Chain, network_of, stages_in_turn
from app.bench.settings import Settings
from app.bench.tables import Chart, Table
from app.bench.timing import paired, round_trip, seconds
from app.bench.truth_pictures import Sensor, cosine_spectrum, mirrored_column
from core.network import Network
from core.physics.line_scanner import (
    filter_line_by_line,
    line_intervals_mrad,
    scale_nodes_mrad,
    scale_weights,
    view_angles_rad,
)
from core.policy import Policy
from core.product import Product

Array = NDArray[Any]
FIELDS_DEG = (30.0, 80.0)  # the thesis' line scanner, and a wide one for survey from the air
# The thesis' line scanner: 75 mm at 10 µm, and 600 µm over 130 mm times the fill factor.
SENSOR: dict[str, Any] = {"aperture_mm": 75.0, "wavelength_um": 10.0, "aberration_mrad": 0.5}
PITCH_UM, FOCAL_LENGTH_MM, FILL = 600.0, 130.0, 0.95
ALTITUDE_M = 402.0
COUNTS = (2, 3, 4, 5)
COLUMNS_CHECKED = 16
LARGEST = 512  # line by line takes a plane of the transfer function for every line
END = "back.image"


@dataclass(frozen=True)
class Scanner:
    """A scan of a field of view, its lines as far apart at nadir as its samples."""

    size: int
    field_deg: float

    @cached_property
    def chain(self) -> Chain:
        """The network, its scene in memory."""
        return Chain(_network(self.size, self.field_deg), Policy())

    @property
    def interval_mrad(self) -> float:
        """Angle between the samples of a scan line, and between scan lines at nadir."""
        return math.radians(self.field_deg) * 1000.0 / self.size

    @cached_property
    def in_flight_mrad(self) -> Array:
        """Angle between scan lines at each sample of them."""
        angles = view_angles_rad(columns=self.size, interval_mrad=self.interval_mrad)
        spacing = self.interval_mrad * 1e-3 * ALTITUDE_M
        return line_intervals_mrad(
            line_spacing_m=spacing, altitude_m=ALTITUDE_M, view_angle_rad=angles
        )

    def whole(self, interval_mrad: float | None = None) -> Array:
        """The whole frame filtered, scan lines that far apart everywhere: as at nadir."""
        network = self.chain.network
        if interval_mrad is not None:
            field = math.degrees(interval_mrad * 1e-3 * self.size)
            network = network.with_parameter("init", "fov_y_deg", field)
        return np.asarray(self.chain.value(network, END))

    def blended(self, count: int) -> Array:
        """Whole frames filtered at `count` scales, blended in each column."""
        nodes = scale_nodes_mrad(intervals_mrad=self.in_flight_mrad, count=count)
        weights = scale_weights(nodes_mrad=nodes, intervals_mrad=self.in_flight_mrad)
        picture = np.zeros_like(self.chain.scene)
        for node, weight in zip(nodes, weights.astype(picture.dtype), strict=True):
            picture += weight * self.whole(float(node))
        return np.asarray(picture)

    def line_by_line(self) -> Array:
        """Each line in flight by a direct sum at its own scale."""
        plan = self.chain.engine.plan(self.chain.network)
        product = Product(plan.output("pixel.magnitude").factors)

        def transfer(xi: Array, eta: Array) -> Array:
            return product.total(self.chain.work, xi[0], eta[:, 0])

        return filter_line_by_line(
            self.chain.scene,
            transfer=transfer,
            interval_x_mrad=self.interval_mrad,
            intervals_y_mrad=self.in_flight_mrad,
        )

    def expected(self) -> tuple[Array, Array]:
        """Some columns and what they have to be."""
        columns = np.unique(np.linspace(0, self.size - 1, COLUMNS_CHECKED).round().astype(int))
        pixel_mrad = PITCH_UM / FOCAL_LENGTH_MM * FILL
        sensor = Sensor(self.interval_mrad, **SENSOR, pixel_mrad=pixel_mrad, transfers=0)
        spectrum = cosine_spectrum(self.chain.scene)
        # The interval from the triangle, not from the measured geometry's cosine.
        aside = np.tan((columns - 0.5 * (self.size - 1)) * self.interval_mrad * 1e-3)
        own = self.interval_mrad / np.hypot(1.0, aside)
        found = [
            mirrored_column(spectrum, sensor, column, float(interval))
            for column, interval in zip(columns, own, strict=True)
        ]
        return columns, np.array(found).T


def scanning(settings: Settings) -> list[Table]:
    """Whole image, blended scales and line by line for two fields of view."""
    size = min(settings.small, LARGEST)
    rows: list[dict[str, Any]] = []
    for field in FIELDS_DEG:
        scanner = Scanner(size, field)
        columns, expected = scanner.expected()
        t0 = round_trip(scanner.chain.scene, scanner.chain.policy.workers)
        for choice, subject, pairs in _subjects(scanner, settings):
            picture = subject()[:, columns]
            facts = paired(partial(_cold, scanner, subject), t0, pairs=pairs, warm_up=1).facts()
            error = float(np.abs(picture - expected).max() / np.abs(expected).max())
            rows.append({"field": f"{field:g}°", "choice": choice, **facts, "error": error})
    heads = {
        "field": "field of view",
        "choice": "scales",
        "t0": "T0",
        "ms": "ms",
        "error": "largest error / max",
    }
    text = _text(rows)
    title = f"Line scanner: whole image against line by line, {size}², single precision"
    chart = Chart("t0", "error", "time (T0)", "largest error / max", "choice", "field", lines=True)
    return [Table("scanning", title, heads, tuple(rows), text, chart)]


def _subjects(scanner: Scanner, settings: Settings) -> list[tuple[str, Callable[[], Array], int]]:
    blends = [
        (f"{count} scales", partial(scanner.blended, count), settings.slow_pairs)
        for count in COUNTS
    ]
    return [
        ("whole image", scanner.whole, settings.pairs),
        *blends,
        ("line by line", scanner.line_by_line, settings.slow_pairs),
    ]


def _cold(scanner: Scanner, subject: Callable[[], Array]) -> float:
    scanner.chain.store.clear()
    return seconds(subject)


def _text(rows: list[dict[str, Any]]) -> str:
    whole = {row["field"]: row for row in rows if row["choice"] == "whole image"}
    lines = [row for row in rows if row["choice"] == "line by line"]
    slower = max(row["ms"] / whole[row["field"]]["ms"] for row in lines)
    errors = " and ".join(f"{row['error']:.1g} at {field}" for field, row in whole.items())
    return (
        "Default whole image at nadir's scale, as in 1996: one transform serves, and what errs is "
        f"the width of the blur towards the ends of the scan (by {errors} of the largest value). "
        "Three to five whole images at scales between, blended column by column, come down to "
        f"single precision's rounding; line by line takes {slower:.0f} times as long as one."
    )


def _network(size: int, field_deg: float) -> Network:
    wavelength, diameter_mm = SENSOR["wavelength_um"], SENSOR["aperture_mm"]
    sigma, fields = SENSOR["aberration_mrad"], {"fov_x_deg": field_deg, "fov_y_deg": field_deg}
    optics = {"cut_on_um": wavelength, "cut_off_um": wavelength}
    nodes: dict[str, tuple[str, dict[str, Any]]] = {
        "scene": ("test_scene", {"kind": "dormitory", "width": size, "height": size, **fields}),
        "init": (
            "init_trans",
            {"focal_length_mm": FOCAL_LENGTH_MM, "detector_x_um": PITCH_UM,
             "detector_y_um": PITCH_UM, "fill_x": FILL, "fill_y": FILL, "range_m": ALTITUDE_M},
        ),
        "pupil": ("exit_pupil", {"size_x": 512, "size_y": 512, "radius": 128.0}),
        "optics": (
            "exit_pupil_mtf",
            {**optics, "size_x_cm": 0.2 * diameter_mm, "size_y_cm": 0.2 * diameter_mm},
        ),
        "aberration": ("gaussian_mtf", {"sigma_x_mrad": sigma, "sigma_y_mrad": sigma}),
        "pixel": ("detector_mtf", {}),
        "back": ("back_transform", {}),
    }  # fmt: skip
    links = [
        (SCENE, "init.image"),
        ("pupil.pupil", "optics.pupil"),
        ("init.phase", "optics.phase"),
        *stages_in_turn(["optics", "aberration", "pixel"]),
    ]
    return network_of(nodes, links)


MEASURES = (scanning,)
