"""Transfer functions along the two axes: what mtf.csv and the reports show."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy
from numpy.typing import NDArray

from app.run.transfer_chain import Chain, Stage
from core.errors import Cancelled, ImagechainError
from core.evaluation.work import Work
from core.transfer.factors import Factor
from nodes.analysis.lineage import Line, stage_along
from nodes.analysis.lineage import Stage as LineStage
from nodes.files.common.table_cells import csv_lines

Vector = NDArray[np.float64]
Axis = Literal["x", "y"]
TOTAL = "total"
SYSTEM = "total_with_electronics"


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
    y: Response
    is_product: bool = False

    @property
    def has_phase(self) -> bool:
        return bool(self.x.ptf.any() or self.y.ptf.any())

    @property
    def acts(self) -> bool:
        return self.has_phase or self.has_blur

    @property
    def has_blur(self) -> bool:
        return bool((self.x.mtf != 1).any() or (self.y.mtf != 1).any())


@dataclass(frozen=True)
class Responses:
    """All stages at the plain FFT's frequencies from 0 to Nyquist.

    `beside` has the transfer functions that do not lead to the final picture. `products` has the
    total of the stages before pixels are combined and, where electronics follow, that times
    theirs; it is empty where the stages do not follow one another.
    """

    xi: Vector
    eta: Vector
    stages: tuple[StageResponse, ...]
    beside: tuple[StageResponse, ...]
    products: tuple[StageResponse, ...]


def responses(chain: Chain, work: Work) -> Responses:
    """Evaluate every stage of the chain along both axes; no plane is ever built."""
    grid = chain.grid
    if grid is None:
        empty = np.zeros(0)
        return Responses(empty, empty, (), (), ())
    xi = np.asarray(scipy.fft.rfftfreq(grid.columns, grid.interval_x_mrad))
    eta = np.asarray(scipy.fft.rfftfreq(grid.rows, grid.interval_y_mrad))

    def stage(
        name: str, title: str, factors: Sequence[Factor], is_product: bool = False
    ) -> StageResponse:
        across = response(work, factors, xi, "x")
        return StageResponse(name, title, across, response(work, factors, eta, "y"), is_product)

    stages = [stage(s.node, s.title, s.factors) for s in (*chain.stages, *chain.later)]
    beside = [stage(s.node, s.title, s.factors) for s in chain.beside]
    products = []
    if chain.cascade:
        before = [f for s in chain.stages for f in s.factors]
        products.append(stage(TOTAL, "Total", before, True))
        if chain.later:
            after = [f for s in chain.later for f in s.factors]
            products.append(stage(SYSTEM, "Total with electronics", [*before, *after], True))
    return Responses(xi, eta, tuple(stages), tuple(beside), tuple(products))


def response(work: Work, factors: Iterable[Factor], frequency: Vector, axis: Axis) -> Response:
    """Product of the MTFs and sum of the PTFs along one axis, the other frequency 0."""
    mtf, ptf = np.ones(len(frequency)), np.zeros(len(frequency))
    zero = np.zeros(1)
    for factor in factors:
        along_x = axis == "x"
        plane = (
            factor.plane(work, frequency, zero) if along_x else factor.plane(work, zero, frequency)
        )
        if factor.part == "mtf":
            mtf = mtf * plane.ravel()
        else:
            ptf = ptf + plane.ravel()
    return Response(mtf, ptf)


@dataclass(frozen=True)
class LineStageResponse:
    name: str
    title: str
    response: Response
    is_product: bool = False


@dataclass(frozen=True)
class LineResponses:
    """All stages along a line, from 0 to where it leaves the image's band.

    As `Responses`, but at `frequency`, cycles/mrad along the line. Stages that cannot be
    evaluated are in `failed`, each error once; a product that needs one of them is left out.
    """

    frequency: Vector
    stages: tuple[LineStageResponse, ...]
    beside: tuple[LineStageResponse, ...]
    products: tuple[LineStageResponse, ...]
    failed: tuple[ImagechainError, ...] = ()


def responses_along(
    chain: Chain, work: Work, angle_deg: float, samples: int | None = None
) -> LineResponses:
    """Evaluate every stage of the chain along a line; no plane is ever built.

    The angle is from the xi axis (0°) towards the eta axis (90°); the line has as many points as
    the longer axis of the spectrum, if not given.
    """
    grid = chain.grid
    if grid is None:
        return LineResponses(np.zeros(0), (), (), ())
    line = Line.at(angle_deg)
    frequency = line.frequencies(grid, samples or max(grid.rows, grid.columns) // 2 + 1)
    failed: dict[str, ImagechainError] = {}

    def along(stages: Iterable[Stage]) -> list[LineStageResponse]:
        evaluated = []
        for stage in stages:
            work.check()
            try:
                values = response_along(work, stage.factors, line, frequency)
            except Cancelled:
                raise
            except ImagechainError as error:
                failed[str(error)] = error
            else:
                evaluated.append(LineStageResponse(stage.node, stage.title, values))
        return evaluated

    before, later = along(chain.stages), along(chain.later)
    products = []
    if chain.cascade and len(before) == len(chain.stages):
        products.append(_product(TOTAL, "Total", before, frequency))
        if chain.later and len(later) == len(chain.later):
            both = [*before, *later]
            products.append(_product(SYSTEM, "Total with electronics", both, frequency))
    beside = along(chain.beside)
    return LineResponses(
        frequency, (*before, *later), tuple(beside), tuple(products), tuple(failed.values())
    )


def response_along(
    work: Work, factors: Iterable[Factor], line: Line, frequency: Vector
) -> Response:
    factors = tuple(factors)
    mtfs = tuple(factor for factor in factors if factor.part == "mtf")
    ptfs = tuple(factor for factor in factors if factor.part == "ptf")
    return Response(
        stage_along(work, LineStage("", mtfs), "mtf", line, frequency),
        stage_along(work, LineStage("", ptfs), "ptf", line, frequency),
    )


def _product(
    name: str, title: str, stages: Iterable[LineStageResponse], frequency: Vector
) -> LineStageResponse:
    mtf, ptf = np.ones(len(frequency)), np.zeros(len(frequency))
    for stage in stages:
        mtf, ptf = mtf * stage.response.mtf, ptf + stage.response.ptf
    return LineStageResponse(name, title, Response(mtf, ptf), is_product=True)


def at_nyquist(chain: Chain, work: Work) -> dict[str, float]:
    grid = chain.grid
    if grid is None:
        return {}
    named = {
        stage.node: list(stage.factors) for stage in (*chain.stages, *chain.later, *chain.beside)
    }
    if chain.cascade:
        named[TOTAL] = [f for stage in chain.stages for f in stage.factors]
        if chain.later:
            named[SYSTEM] = [*named[TOTAL], *(f for s in chain.later for f in s.factors)]
    figures = {}
    places: tuple[tuple[Axis, float], ...] = (("x", grid.nyquist_x), ("y", grid.nyquist_y))
    for name, factors in named.items():
        for axis, frequency in places:
            value = response(work, factors, np.array([frequency]), axis)
            figures[f"{name}.mtf_nyquist_{axis}"] = float(value.mtf[0])
            figures[f"{name}.ptf_nyquist_{axis}"] = float(value.ptf[0])
    return figures


def mtf_csv(sampled: Responses) -> str:
    """One line for each frequency; the shorter axis of an oblong frame leaves cells empty."""
    columns: list[tuple[str, Vector]] = [
        ("xi_cyc_per_mrad", sampled.xi),
        ("eta_cyc_per_mrad", sampled.eta),
    ]
    for stage in (*sampled.stages, *sampled.beside, *sampled.products):
        columns += [
            (f"{stage.name}.mtf_x", stage.x.mtf),
            (f"{stage.name}.ptf_x_rad", stage.x.ptf),
            (f"{stage.name}.mtf_y", stage.y.mtf),
            (f"{stage.name}.ptf_y_rad", stage.y.ptf),
        ]
    cells = [[repr(value) for value in column.tolist()] for _, column in columns]
    length = max(len(column) for column in cells)
    filled = [column + [""] * (length - len(column)) for column in cells]
    return csv_lines([[name for name, _ in columns], *zip(*filled, strict=True)])
