"""Choices of the pupil's OTF: closed form or samples, interpolation, low rank."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.bench import truth
from app.bench.kodak import Kodak
from app.bench.settings import Settings
from app.bench.tables import Chart, Table
from app.bench.timing import paired, round_trip
from core.factors import Planar
from core.grid import Grid
from core.network import Network
from core.planes import Planes
from core.product import Product

Array = NDArray[Any]
ARRAY_MM, RADIUS_MM, WAVELENGTH_UM = 128.0, 45.0, 4.0
PART = 1 / 512  # lengths of the pupils, as parts of the array
SHAPES: dict[str, tuple[dict[str, float], truth.Aperture | None]] = {
    "clear": ({}, truth.Aperture(RADIUS_MM)),
    "half_moon": ({}, truth.Aperture(RADIUS_MM, half_moon=True)),
    "cassegrain": ({"obscuration_radius": 60}, truth.Aperture(RADIUS_MM, inner=15)),
    "hinged": ({"slit_width": 20}, truth.Aperture(RADIUS_MM, half_bar=2.5)),
    "cassegrain_slit": (
        {"obscuration_radius": 60, "slit_width": 20},
        truth.Aperture(RADIUS_MM, inner=15, half_bar=2.5),
    ),
    "spider": ({"obscuration_radius": 60, "vanes": 4, "vane_width": 4}, None),
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
        found = plan.output("optics.mtf").factors[0]
        assert isinstance(found, Planar)
        return found

    def direct(self) -> float:
        """Seconds of evaluating it at every frequency, nothing known before."""
        return self._seconds(lambda factor: self._blocks(lambda rows: self._plane(factor, rows)))

    def low_rank(self) -> float:
        """Seconds of the same by thin matrices, where they serve."""

        def evaluate(factor: Planar) -> None:
            self._blocks(self.planes(factor).block)

        return self._seconds(evaluate)

    def known(self) -> float:
        """Seconds of the thin matrices' product alone."""
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

        self.kodak.work.each(one, range(0, self.grid.rows, ROWS_AT_ONCE))

    def _plane(self, factor: Planar, rows: slice) -> Array:
        xi, eta = self.axes
        return factor.transfer(self.kodak.work, xi[np.newaxis, :], eta[rows, np.newaxis])

    @cached_property
    def grid(self) -> Grid:
        """Sampling of the picture."""
        found = self.kodak.engine.plan(self.network).output("init.context").grid
        assert isinstance(found, Grid)
        return found

    @cached_property
    def axes(self) -> tuple[Array, Array]:
        """Frequencies across and along."""
        return self.grid.xi_mirrored(), self.grid.eta_mirrored()


def sampling(settings: Settings) -> list[Table]:
    """Closed form against autocorrelations of sampled pupils, and how these are interpolated."""
    kodak = Kodak(settings.small)
    sizes = (64, 128, 256) if settings.quick else (64, 128, 256, 512, 1024)
    rows = []
    for shape in ("clear", "half_moon"):
        otf = Otf(kodak, _pupil(kodak.network, shape, 512))
        named = {"mark": "exact", "curve": f"{shape}, exact"}
        rows.append(
            {"shape": shape, "choice": "exact", **named, **_measured(otf, shape, otf.direct, 3)}
        )
        for size in sizes:
            for how in ("bilinear", "linear"):
                network = _pupil(kodak.network, shape, size)
                network = network.with_parameter("optics", "method", "autocorrelation")
                otf = Otf(kodak, network.with_parameter("optics", "interpolation", how))
                found = _measured(otf, shape, otf.direct, 2 if settings.quick else 3)
                named = {"curve": f"{shape}, {how}"}
                if (shape, how) == ("clear", "bilinear"):  # names of the rest would lie on these
                    named["mark"] = f"{size}²"
                rows.append({"shape": shape, "choice": f"{size}² {how}", **named, **found})
    heads = {"shape": "pupil", "choice": "OTF", "t0": "T0", "ms": "ms", "error": "largest error"}
    text = (
        "Default exact: no sampled pupil comes near the closed form's error, at any price. Samples "
        "(bilinear between their lags unless asked otherwise) are for pupils from files and with "
        "a wavefront error, where there is none; interpolation `none` only shows the raw "
        "autocorrelation and filters nothing."
    )
    title = f"Pupil: closed form and sampled, on the frequencies of a picture of {settings.small}²"
    chart = Chart(
        "t0", "error", "time (T0)", "largest error", label="mark", group="curve", lines=True
    )
    return [Table("pupil_sampling", title, heads, tuple(rows), text, chart)]


def low_rank(settings: Settings) -> list[Table]:
    """Thin matrices against evaluating the closed form at every frequency."""
    kodak = Kodak(settings.small)
    rows = []
    pairs = 2 if settings.quick else 5
    for shape in SHAPES:
        otf = Otf(kodak, _pupil(kodak.network, shape, 512))
        factor = otf.factor
        size = len(kodak.scene)
        every, planes = np.arange(size), otf.planes(factor)
        thin = np.concatenate([
            np.asarray(planes.block(slice(start, start + ROWS_AT_ONCE)))
            for start in range(0, size, ROWS_AT_ONCE)
        ])  # fmt: skip
        direct = otf.at(every[:, np.newaxis], every[np.newaxis, :])
        places = _places(size)
        expected = _expected(otf, shape, *places)
        for choice, plane, subject in (
            ("direct", direct, otf.direct),
            ("low rank", thin, otf.low_rank),
            ("low rank, known", thin, otf.known),
        ):
            t0 = round_trip(kodak.scene, kodak.policy.workers)
            error = None
            if expected is not None:
                error = float(np.abs(plane[places] - expected).max())
            rows.append(
                {
                    "shape": shape,
                    "choice": choice,
                    "mark": choice if shape == "clear" else None,
                    **paired(subject, t0, pairs=pairs, warm_up=1).facts(),
                    "error": error,
                    "from_direct": float(np.abs(plane - direct).max()),
                }
            )
    heads = {
        "shape": "pupil",
        "choice": "OTF plane",
        "t0": "T0",
        "ms": "ms",
        "error": "error at points",
        "from_direct": "difference, whole plane",
    }
    text = (
        "Default low rank in single precision, whose rounding covers its error: found once, it is "
        "kept, and a later picture takes the matrix product alone (known). Direct in double "
        "precision and where no low rank is found."
    )
    title = f"Pupil OTF by thin matrices, {settings.small}² frequencies"
    chart = Chart("t0", "error", "time (T0)", "error at points", "mark", "shape", lines=True)
    return [Table("low_rank", title, heads, tuple(rows), text, chart)]


def _pupil(network: Network, shape: str, size: int) -> Network:
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


def _measured(otf: Otf, shape: str, subject: Callable[[], float], pairs: int) -> dict[str, Any]:
    kodak = otf.kodak
    t0 = round_trip(kodak.scene, kodak.policy.workers)
    facts = paired(subject, t0, pairs=pairs, warm_up=1).facts()
    places = _places(len(kodak.scene))
    expected = _expected(otf, shape, *places)
    assert expected is not None
    return {**facts, "error": float(np.abs(otf.at(*places) - expected).max())}


def _places(size: int) -> tuple[Array, Array]:
    """Rows and columns of the grid: along both axes, near the cusp at zero, and in between."""
    drawn = np.random.default_rng(7)
    rows, columns = drawn.integers(0, size, (2, POINTS))
    rows[: POINTS // 4] = 0
    columns[POINTS // 4 : POINTS // 2] = 0
    near = [math.floor(x) for x in np.geomspace(1, size - 1, POINTS // 4)]
    columns[: POINTS // 4], rows[POINTS // 4 : POINTS // 2] = near, near
    return rows, columns


def _expected(otf: Otf, shape: str, rows: Array, columns: Array) -> Array | None:
    aperture = SHAPES[shape][1]
    if aperture is None:
        return None
    lags = zip(*otf.lags_mm(rows, columns), strict=True)
    return np.array([aperture.otf(float(x), float(y)) for x, y in lags])


MEASURES = (sampling, low_rank)
