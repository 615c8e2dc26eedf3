"""OTFs of a network's pupils on the frequencies its picture needs, and their truth."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench.measuring.kodak import Kodak
from app.bench.truth.truth_pupils import Aperture
from core.network.network import Network
from core.transfer.factors import Planar
from core.transfer.grid import Grid
from core.transfer.planar_blocks import Planes
from core.transfer.product import Product

Array = NDArray[Any]
ARRAY_MM, RADIUS_MM, WAVELENGTH_UM = 128.0, 45.0, 4.0
PART = 1 / 512  # lengths of the pupils, as parts of the array
SHAPES: dict[str, tuple[dict[str, float], Aperture]] = {
    "clear": ({}, Aperture(RADIUS_MM)),
    "half_moon": ({}, Aperture(RADIUS_MM, half_moon=True)),
    "cassegrain": ({"obscuration_radius": 60}, Aperture(RADIUS_MM, inner=15)),
    "hinged": ({"slit_width": 20}, Aperture(RADIUS_MM, half_bar=2.5)),
    "cassegrain_slit": (
        {"obscuration_radius": 60, "slit_width": 20},
        Aperture(RADIUS_MM, inner=15, half_bar=2.5),
    ),
    "spider": (
        {"obscuration_radius": 60, "vanes": 4, "vane_width": 4},
        Aperture(RADIUS_MM, inner=15, half_bar=0.5, half_beam=0.5),
    ),
}
POINTS = 24
ROWS_AT_ONCE = 64


@dataclass(frozen=True)
class Otf:
    """The OTF that a network's pupil has, on the frequencies its picture needs."""

    kodak: Kodak
    network: Network

    @cached_property
    def factor(self) -> Planar:
        """The transfer factor; no array is in it."""
        plan = self.kodak.engine.plan(self.network)
        factor = plan.output("optics.mtf").factors[0]
        assert isinstance(factor, Planar)
        return factor

    def direct(self) -> float:
        """Seconds of evaluating it at every frequency, with nothing computed before."""
        return self._seconds(lambda factor: self._blocks(lambda rows: self._plane(factor, rows)))

    def plane(self) -> float:
        """Seconds of the plane as a picture's filter takes it."""

        def evaluate(factor: Planar) -> None:
            self._blocks(self.planes(factor).block)

        return self._seconds(evaluate)

    def known(self) -> float:
        """Seconds of reading the plane once it is known."""
        planes = self.planes(self.factor)
        start = time.perf_counter()
        self._blocks(planes.block)
        return time.perf_counter() - start

    def planes(self, factor: Planar) -> Planes:
        """The factor as a picture's filter takes it."""
        return Planes(self.kodak.work, Product([factor]), self.grid, "mirrored")

    def at(self, rows: Array, columns: Array) -> Array:
        """Values at some of the grid's frequencies."""
        xi, eta = self.axes
        return self.factor.transfer(self.kodak.work, xi[columns], eta[rows])

    def lags_mm(self, rows: Array, columns: Array) -> tuple[Array, Array]:
        """Lags across the pupil that these frequencies stand for."""
        xi, eta = self.axes
        return WAVELENGTH_UM * xi[columns], WAVELENGTH_UM * eta[rows]

    def _seconds(self, evaluate: Callable[[Planar], None]) -> float:
        self.kodak.store.clear()
        start = time.perf_counter()
        evaluate(self.factor)
        return time.perf_counter() - start

    def _blocks(self, block: Callable[[slice], object]) -> None:
        def one(start: int) -> None:
            block(slice(start, start + ROWS_AT_ONCE))

        self.kodak.work.for_each(one, range(0, self.grid.rows, ROWS_AT_ONCE))

    def _plane(self, factor: Planar, rows: slice) -> Array:
        xi, eta = self.axes
        return factor.transfer(self.kodak.work, xi[np.newaxis, :], eta[rows, np.newaxis])

    @cached_property
    def grid(self) -> Grid:
        """Sampling of the picture."""
        grid = self.kodak.engine.plan(self.network).output("init.context").grid
        assert isinstance(grid, Grid)
        return grid

    @cached_property
    def axes(self) -> tuple[Array, Array]:
        """Frequencies across and along."""
        return self.grid.xi_mirrored(), self.grid.eta_mirrored()


def pupil_network(network: Network, shape: str, size: int) -> Network:
    """The pupil of that shape at `size` samples over the same array."""
    chosen: dict[str, Any] = {
        "shape": shape,
        "size_x": size,
        "size_y": size,
        "radius": RADIUS_MM / ARRAY_MM * size,
    }
    for name, value in SHAPES[shape][0].items():
        chosen[name] = value if name == "vanes" else value * PART * size
    for name, value in chosen.items():
        network = network.with_parameter("pupil", name, value)
    return network


def places_of(size: int) -> tuple[Array, Array]:
    """Rows and columns of the grid: along both axes, near the cusp at zero, and in between."""
    drawn = np.random.default_rng(7)
    rows, columns = drawn.integers(0, size, (2, POINTS))
    rows[: POINTS // 4] = 0
    columns[POINTS // 4 : POINTS // 2] = 0
    near = [math.floor(x) for x in np.geomspace(1, size - 1, POINTS // 4)]
    columns[: POINTS // 4], rows[POINTS // 4 : POINTS // 2] = near, near
    return rows, columns


def expected_at(shape: str, lags_mm: tuple[Array, Array]) -> Array:
    """The OTF at lags across the pupil."""
    aperture = SHAPES[shape][1]
    return np.array([aperture.otf(float(x), float(y)) for x, y in zip(*lags_mm, strict=True)])
