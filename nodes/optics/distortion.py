"""Distortion: the lens displaces every point of the picture."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np

from core.arrays import Array
from core.chain.noise_power import NoisePower, Operator
from core.chain.step_lineage import Axis as AxisName
from core.chain.step_lineage import Linear, picture_step
from core.chain.wires import Image
from core.errors import DataError, ParameterError
from core.evaluation.recipes import in_blocks
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, readout, warning
from core.modules.parameters import Caution, Formula, Section, param
from core.physics.optics.field import Distortion as Lens
from core.physics.optics.field import samples_at
from core.records import dataclass
from core.transfer.factors import Grid
from nodes.shared.module_ports import ImageOutput, NewHeight, NewWidth
from nodes.shared.steps import stepped

_TILE = 128  # samples on a side that are made at a time, of so many of the picture before
_MOST_READ = 1 << 22
_SURVEYED = 129  # rays along each axis, for the figures
_COARSE = 1.5  # source samples from one ray to the next, above which detail is skipped
_WIDEST_DEG = 180.0  # of a field that can be typed
_K: dict[str, Any] = {"low": -1e6, "high": 1e6, "slider": (-0.5, 0.5)}


class Distortion(Module, key="distortion", title="Distortion", group="Optics"):
    """Distort the picture like a lens, with Brown–Conrady or fisheye coefficients.

    The incoming picture must be free of distortion: distances from the axis are tangents of field
    angles. Coefficients, centre and signs follow OpenCV, with lengths divided by the focal length.
    `fisheye` with all coefficients at 0 is an f-θ lens. The module traces the ray of each sample
    (to 1e-11 of the focal length) and interpolates the picture there from 8 × 8 samples. Sinusoids
    of up to 0.2 cycles per sample are misplaced by less than 1e-3 sample. The picture is not
    filtered: if `largest_step` is well above 1, sample the scene more finely. A lens with barrel
    distortion images points beyond the frame. Give the scene more samples at the same interval; the
    scene's field of view is samples times interval, not 2·atan(Np/2f) as for a lens. Set `width`
    and `height` to the camera's samples. A warning gives the required sizes. Beyond the scene, the
    outermost samples are repeated. MTF and noise are valid on the axis, where nothing is stretched.
    Sources: Brown 1966; Kannala and Brandt 2006; OpenCV, camera calibration.
    """

    formulas = (
        Formula(
            r"x'=x\,(1+k_1r^2+k_2r^4+k_3r^6)+2p_1xy+p_2(r^2+2x^2)",
            where="x, y: tangents of angles from the axis, to the right and down; r² = x² + y²; "
            "y' has the same form, with p₁ and p₂ exchanged",
            when="brown",
        ),
        Formula(
            r"r'=\theta\,(1+k_1\theta^2+k_2\theta^4+k_3\theta^6+k_4\theta^8)",
            where="θ: angle from the axis; r': distance in the picture divided by the focal length",
            when="fisheye",
        ),
    )

    model: Literal["brown", "fisheye"] = param(
        "brown", "model of the distortion, Brown–Conrady or fisheye (f-θ)"
    )
    k1: float = param(0.0, "radial coefficient of r² or θ²", **_K)
    k2: float = param(0.0, "radial coefficient of r⁴ or θ⁴", **_K)
    k3: float = param(0.0, "radial coefficient of r⁶ or θ⁶", **_K)
    k4: float = param(0.0, "radial coefficient of θ⁸", **_K)
    p1: float = param(0.0, "tangential coefficient: shifts points mostly along y", **_K)
    p2: float = param(0.0, "tangential coefficient: shifts points mostly along x", **_K)
    centre_x_mrad: float = param(
        0.0,
        "offset of the optical axis to the right of the picture's middle",
        (-1e4, 1e4),
        slider=(-20, 20),
    )
    centre_y_mrad: float = param(
        0.0, "offset of the optical axis below the picture's middle", (-1e4, 1e4), slider=(-20, 20)
    )
    width: NewWidth = None
    height: NewHeight = None

    panel = (
        Section("Lens", "model k1 k2 k3"),
        Section("", "k4", shown_when=("model", ("fisheye",))),
        Section("", "p1 p2", shown_when=("model", ("brown",))),
        Section("Axis", "centre_x_mrad centre_y_mrad"),
        Section("Size", "width height"),
    )

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        rays = self.rays(image)
        if rays.straight:
            return ImageOutput(image)
        if not np.isfinite(survey(rays).step):
            names = ("k1", "k2", "k3", "k4", "p1", "p2", "centre_x_mrad", "centre_y_mrad")
            bent = next((name for name in names if getattr(self, name)), "k1")
            allowed = (
                "the picture would fold back within its frame; make the field smaller, or check "
                "the signs of the coefficients"
            )
            raise ParameterError(bent, getattr(self, bent), allowed)
        rows, columns = rays.new
        step = here.step(distorted, image.recipe, rays=rays)
        return ImageOutput(stepped(image, step, rows=rows, columns=columns, edges=None))

    def rays(self, image: Image) -> Rays:
        k = (self.k1, self.k2, self.k3, *((self.k4,) if self.model == "fisheye" else ()))
        lens = Lens(self.model, k, (self.p1, self.p2))
        centre = 1e-3 * self.centre_x_mrad, 1e-3 * self.centre_y_mrad
        new = self.height or image.rows, self.width or image.columns
        return Rays(lens, centre, image.grid(), new)

    @warning
    def beyond(self, image: Image) -> Caution | None:
        """Rays come from beyond the picture."""
        rays = self.rays(image)
        found, grid = survey(rays), rays.grid
        if not found.beyond:
            return None
        rows, columns = found.needed
        x, y = (math.degrees(1e-3 * interval * n) for interval, n in
                ((grid.interval_x_mrad, columns), (grid.interval_y_mrad, rows)))  # fmt: skip
        remedy = "use a smaller frame: the scene would have to be 180° wide or more"
        if max(x, y) < _WIDEST_DEG:
            remedy = (
                f"make the scene {columns} × {rows} samples with fov_x_deg = {x:.9g} and fov_y_deg "
                f"= {y:.9g}, and set width = {rays.new[1]} and height = {rays.new[0]} here"
            )
        return Caution(
            f"{100 * found.beyond:.3g} % of the samples lie beyond the scene and repeat its border",
            remedy,
        )

    @warning
    def coarse(self, image: Image) -> Caution | None:
        """Rays skip samples of the picture."""
        step = survey(self.rays(image)).step
        if step <= _COARSE:
            return None
        return Caution(
            f"fine detail may alias: neighbouring rays are up to {step:.3g} scene samples apart",
            "sample the scene more finely, and put Combine Pixels or Sample Pixels after this node",
        )

    @readout("%")
    def corner_percent(self, image: Image) -> float:
        """Distortion at the corner: distorted over undistorted distance from the axis, minus 1."""
        return 100.0 * survey(self.rays(image)).corner

    @readout("%")
    def beyond_percent(self, image: Image) -> float:
        """Share of the samples that lie beyond the scene."""
        return 100.0 * survey(self.rays(image)).beyond

    @readout("samples")
    def largest_step(self, image: Image) -> float:
        """Largest distance in the scene between neighbouring rays of a row or column."""
        return survey(self.rays(image)).step


@dataclass(frozen=True)
class Rays(Linear):
    """Where the light of each sample comes from; on the axis only the frame's size changes."""

    lens: Lens
    centre: tuple[float, float]
    grid: Grid
    new: tuple[int, int]

    @property
    def straight(self) -> bool:
        bent = self.lens.model == "fisheye" or any(self.lens.k) or any(self.lens.p)
        return not bent and self.new == self.grid.shape

    def tangents(self, row: Array, column: Array) -> tuple[Array, Array]:
        rows, columns = self.new
        x = 1e-3 * self.grid.interval_x_mrad * (column - 0.5 * (columns - 1)) - self.centre[0]
        y = 1e-3 * self.grid.interval_y_mrad * (row - 0.5 * (rows - 1)) - self.centre[1]
        return np.broadcast_arrays(x, y)  # type: ignore[return-value]

    def of(self, row: Array, column: Array) -> tuple[Array, Array]:
        x, y = self.lens.undistorted(*self.tangents(row, column))
        grid = self.grid
        return (
            1e3 * (x + self.centre[0]) / grid.interval_x_mrad + 0.5 * (grid.columns - 1),
            1e3 * (y + self.centre[1]) / grid.interval_y_mrad + 0.5 * (grid.rows - 1),
        )

    def size_before(self, rows: int, columns: int) -> tuple[int, int]:
        return self.grid.shape

    def grid_before(self, grid: Grid) -> Grid:
        return Grid(*self.grid.shape, grid.interval_x_mrad, grid.interval_y_mrad)

    def noise(self, work: Work, power: NoisePower) -> NoisePower:
        along, across = map(_middle_of, self.grid.shape, self.new)
        return power.resampled(self.new, along, across)

    def row(self, work: Work, row: Array, axis: AxisName) -> Array:
        new = self.new[1 if axis == "x" else 0]
        return np.asarray(_middle_of(len(row), new)(row[:, np.newaxis])[:, 0], np.float64)


class Survey(NamedTuple):
    """Distortion at the corner, share of rays beyond the scene, largest step, size `needed`."""

    corner: float
    beyond: float
    step: float
    needed: tuple[int, int]


@lru_cache(maxsize=64)
def survey(rays: Rays) -> Survey:
    row, column = (np.linspace(0, n - 1, min(n, _SURVEYED)) for n in rays.new)
    row = row[:, np.newaxis]
    place = np.array(rays.of(row, column))
    inward = row - np.sign(row - row.mean()), column - np.sign(column - column.mean())
    steps = [np.hypot(*(rays.of(*next_to) - place)) for next_to in
             ((inward[0], column), (row, inward[1]))]  # fmt: skip
    half = 0.5 * np.array([[[rays.grid.columns]], [[rays.grid.rows]]])
    out = np.abs(place + 0.5 - half) - half
    across, along = np.ceil(np.nan_to_num(out, posinf=0.0).max(axis=(1, 2))).clip(0.0).astype(int)
    there = np.array(rays.tangents(row, column)).reshape(2, -1)
    furthest = there[:, np.argmax(np.hypot(*there))]
    before = np.hypot(*rays.lens.undistorted(*furthest))
    corner = np.hypot(*furthest) / before - 1.0 if before else 0.0
    needed = rays.grid.rows + 2 * int(along), rays.grid.columns + 2 * int(across)
    beyond = float((out > 0.0).any(axis=0).mean())
    return Survey(float(corner), beyond, float(np.max(steps)), needed)


def _middle_of(old: int, new: int) -> Operator:
    index = np.clip(np.arange(new) + (old - new) // 2, 0, old - 1)
    return lambda waves: waves[index]


@picture_step(linear=lambda _, rays: rays)
@in_blocks()
def distorted(work: Work, image: Array, *, rays: Rays) -> Array:
    """By tiles, each from the part of the picture that its rays come from."""
    rows, columns = rays.new
    made: Array = work.empty(rays.new, image.dtype)

    def tile(place: tuple[int, int, int]) -> None:
        top, left, side = place
        row = np.arange(top, min(top + side, rows))
        column = np.arange(left, min(left + side, columns))
        if not (row.size and column.size):
            return
        x, y = rays.of(row[:, np.newaxis], column)
        if not np.isfinite(x).all():
            raise DataError("the picture folds back within its frame: check the coefficients")
        spans = (
            np.ptp(np.clip(part, 0, n)) for part, n in ((y, image.shape[0]), (x, image.shape[1]))
        )
        if math.prod(spans) > _MOST_READ and side > 1:  # the rays are far apart
            half = side // 2
            for down, right in ((0, 0), (0, half), (half, 0), (half, half)):
                tile((top + down, left + right, half))
            return
        place_made = slice(top, top + side), slice(left, left + side)
        made[place_made] = samples_at(picture=image, x=x, y=y)

    tops, lefts = range(0, rows, _TILE), range(0, columns, _TILE)
    places = [(top, left, _TILE) for top in tops for left in lefts]
    work.for_each(tile, places)
    return made
