"""Transfer functions along the two axes: what mtf.csv and the reports show."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from app.run.transfer_chain import Chain, Stage
from core.errors import Cancelled, ImagechainError
from core.evaluation.work import Work
from core.transfer.factors import Factor, Part
from nodes.analysis.lineage import HORIZONTAL, VERTICAL, Line, stage_along
from nodes.analysis.lineage import Stage as LineStage
from nodes.files.common.table_cells import csv_lines

Vector = NDArray[np.float64]
Axis = Literal["x", "y"]
TOTAL = "total"
SYSTEM = "total_with_electronics"
_SYSTEM_TITLE = "Total with electronics"


@dataclass(frozen=True)
class Response:
    """Signed MTF and PTF (radians) along one axis."""

    mtf: Vector
    ptf: Vector


@dataclass(frozen=True)
class StageResponse:
    name: str
    title: str
    x: Response
    y: Response = Response(np.zeros(0), np.zeros(0))
    is_product: bool = False

    @property
    def has_phase(self) -> bool:
        return bool(self.x.ptf.any() or self.y.ptf.any())

    @property
    def has_blur(self) -> bool:
        return bool((self.x.mtf != 1).any() or (self.y.mtf != 1).any())

    @property
    def acts(self) -> bool:
        return self.has_phase or self.has_blur


@dataclass(frozen=True)
class Responses:
    """All stages at the plain FFT's frequencies from 0 to Nyquist, or along a line (then in `x`).

    `products` has the total before pixels are combined, and with the electronics; it is empty
    where the stages do not follow one another.
    """

    xi: Vector
    eta: Vector
    stages: tuple[StageResponse, ...]
    beside: tuple[StageResponse, ...]
    products: tuple[StageResponse, ...]
    failed: tuple[ImagechainError, ...] = ()


def responses(chain: Chain, work: Work) -> Responses:
    """Evaluate every stage of the chain along both axes; no plane is ever built."""
    grid = chain.grid
    if grid is None:
        empty = np.zeros(0)
        return Responses(empty, empty, (), (), ())
    xi = np.asarray(scipy.fft.rfftfreq(grid.columns, grid.interval_x_mrad))
    eta = np.asarray(scipy.fft.rfftfreq(grid.rows, grid.interval_y_mrad))

    def sampled(stages: Iterable[Stage], *, is_product: bool = False) -> tuple[StageResponse, ...]:
        return tuple(
            StageResponse(
                stage.node,
                stage.title,
                response(work, stage.factors, xi, "x"),
                response(work, stage.factors, eta, "y"),
                is_product,
            )
            for stage in stages
        )

    stages = sampled((*chain.stages, *chain.later))
    return Responses(
        xi, eta, stages, sampled(chain.beside), sampled(_products(chain), is_product=True)
    )


def _products(chain: Chain) -> list[Stage]:
    if not chain.cascade:
        return []
    before = tuple(factor for stage in chain.stages for factor in stage.factors)
    whole = [Stage(SYSTEM, _SYSTEM_TITLE, chain.factors)] if chain.later else []
    return [Stage(TOTAL, "Total", before), *whole]


def response(
    work: Work, factors: Iterable[Factor], frequency: Vector, line: Axis | Line
) -> Response:
    """Product of the MTFs and sum of the PTFs along an axis, or a line."""
    if not isinstance(line, Line):
        line = HORIZONTAL if line == "x" else VERTICAL
    factors = tuple(factors)

    def along(part: Part) -> Vector:
        stage = LineStage("", tuple(factor for factor in factors if factor.part == part))
        return stage_along(work, stage, part, line, frequency)

    return Response(along("mtf"), along("ptf"))


def mtf_at(work: Work, factors: Iterable[Factor], frequency: float, axis: Axis) -> float:
    return float(response(work, factors, np.array([frequency]), axis).mtf[0])


def responses_along(
    chain: Chain, work: Work, angle_deg: float, samples: int | None = None
) -> Responses:
    """Every stage along a line at an angle from the xi axis (0°) to the eta axis (90°)."""
    grid = chain.grid
    if grid is None:
        return Responses(np.zeros(0), np.zeros(0), (), (), ())
    line = Line.at(angle_deg)
    frequency = line.frequencies(grid, samples or max(grid.rows, grid.columns) // 2 + 1)
    failed: dict[str, ImagechainError] = {}

    def along(stages: Iterable[Stage]) -> list[StageResponse]:
        evaluated = []
        for stage in stages:
            work.check()
            try:
                values = response(work, stage.factors, frequency, line)
            except Cancelled:
                raise
            except ImagechainError as error:
                failed[str(error)] = error
            else:
                evaluated.append(StageResponse(stage.node, stage.title, values))
        return evaluated

    before, later = along(chain.stages), along(chain.later)
    products = []
    if chain.cascade and len(before) == len(chain.stages):
        products.append(_product(TOTAL, "Total", before, frequency))
        if chain.later and len(later) == len(chain.later):
            both = [*before, *later]
            products.append(_product(SYSTEM, _SYSTEM_TITLE, both, frequency))
    beside = along(chain.beside)
    stages, errors = (*before, *later), tuple(failed.values())
    return Responses(frequency, np.zeros(0), stages, tuple(beside), tuple(products), errors)


def _product(
    name: str, title: str, stages: Iterable[StageResponse], frequency: Vector
) -> StageResponse:
    mtf, ptf = np.ones(len(frequency)), np.zeros(len(frequency))
    for stage in stages:
        mtf, ptf = mtf * stage.x.mtf, ptf + stage.x.ptf
    return StageResponse(name, title, Response(mtf, ptf), is_product=True)


def at_nyquist(chain: Chain, work: Work) -> dict[str, float]:
    grid = chain.grid
    if grid is None:
        return {}
    figures = {}
    places: tuple[tuple[Axis, float], ...] = (("x", grid.nyquist_x), ("y", grid.nyquist_y))
    for stage in (*chain.stages, *chain.later, *chain.beside, *_products(chain)):
        for axis, frequency in places:
            value = response(work, stage.factors, np.array([frequency]), axis)
            figures[f"{stage.node}.mtf_nyquist_{axis}"] = float(value.mtf[0])
            figures[f"{stage.node}.ptf_nyquist_{axis}"] = float(value.ptf[0])
    return figures


def mtf_csv(sampled: Responses) -> str:
    """One line for each frequency; the shorter axis of an oblong frame leaves cells empty."""
    columns = [("xi_cyc_per_mrad", sampled.xi), ("eta_cyc_per_mrad", sampled.eta)]
    for stage in (*sampled.stages, *sampled.beside, *sampled.products):
        for axis, along in (("x", stage.x), ("y", stage.y)):
            columns.append((f"{stage.name}.mtf_{axis}", along.mtf))
            columns.append((f"{stage.name}.ptf_{axis}_rad", along.ptf))
    cells = ([repr(value) for value in column.tolist()] for _, column in columns)
    return csv_lines([[name for name, _ in columns], *itertools.zip_longest(*cells, fillvalue="")])
