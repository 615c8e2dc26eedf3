"""The queries of the plot viewer: the chain's transfer functions, and what a port has to plot."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

from app.editor.declared_text import error_text
from app.editor.evaluation.queries import Passing, Query
from app.run.output import HOW_TO_MARK, sound_part
from app.run.responses import LineStageResponse, responses_along
from app.run.transfer_chain import Chain, find_chain
from core.chain.engine import Plan
from core.chain.results import CurveData, CurveMark, TableData
from core.chain.wires import Curve, Table
from core.errors import NetworkError
from core.transfer.factors import Grid, Planar
from nodes.analysis.lineage.line_transfer import Line

Vector = NDArray[np.float64]
Kind = Literal["stage", "beside", "total"]
FINEST = 1025  # points of a curve


@dataclass(frozen=True, eq=False)
class TransferCurve:
    name: str  # the node's id, or that of a product
    title: str  # for people, unique in the plot
    kind: Kind  # whether it leads to the final picture, stands beside, or is a product
    mtf: Vector  # mtf, ptf: signed MTF, and PTF in radians
    ptf: Vector

    @property
    def acts(self) -> bool:
        return bool((self.mtf != 1).any() or self.ptf.any())


@dataclass(frozen=True, eq=False)
class TransferCurves:
    angle_deg: float  # direction of the line
    frequency: Vector  # cycles/mrad along the line
    curves: tuple[TransferCurve, ...]  # the stages and products
    # frequencies along the line: the cutoff of the optics and Nyquist, which is that of the
    # spectrum's samples, called so where the pixels', of a coarser pitch or once samples are
    # combined, is marked beside it
    marks: tuple[CurveMark, ...]
    # what cannot be planned or computed, and why, in one line; empty where all can
    trouble: str = ""
    missing: str = ""  # why there is no total, in one line; empty where there is one


@dataclass(frozen=True)
class CurvesQuery(Query):
    """MTF and PTF of every stage that leads to the final picture, and of their product.

    Of a network with errors, what can be planned.
    """

    urgency: ClassVar[int] = 1

    angle_deg: float = 0.0  # direction of the line: 0 across, 90 along

    def key(self, plan: Plan) -> Hashable:
        sound = sound_part(plan)
        chain = find_chain(sound)
        stages = tuple(
            (stage.node, stage.title, tuple((f.key, f.node) for f in stage.factors))
            for stage in (*chain.stages, *chain.later, *chain.beside)
        )
        parts = len(chain.stages), len(chain.later), chain.missing
        return self, chain.grid, chain.combined, parts, stages, _trouble(plan, ())

    def answer(self, passing: Passing) -> TransferCurves:
        chain = find_chain(sound_part(passing.plan))
        grid = chain.grid
        if grid is None:
            trouble = _trouble(passing.plan, ())
            missing = _missing(chain)
            return TransferCurves(self.angle_deg, np.zeros(0), (), (), trouble, missing)
        samples = min(FINEST, max(grid.rows, grid.columns) // 2 + 1)
        responses = responses_along(chain, passing.work, self.angle_deg, samples)
        groups: tuple[tuple[Kind, tuple[LineStageResponse, ...]], ...] = (
            ("stage", responses.stages),
            ("beside", responses.beside),
            ("total", responses.products),
        )
        curves = tuple(
            TransferCurve(
                stage.name,
                stage.title if kind == "total" else stage.name,
                kind,
                stage.response.mtf,
                stage.response.ptf,
            )
            for kind, stages in groups
            for stage in stages
        )
        marks = _marks(chain, grid, Line.at(self.angle_deg))
        trouble = _trouble(passing.plan, tuple(error_text(error) for error in responses.failed))
        return TransferCurves(
            self.angle_deg, responses.frequency, curves, marks, trouble, _missing(chain)
        )


@dataclass(frozen=True)
class PortDataQuery(Query):
    urgency: ClassVar[int] = 1

    port: str  # ``NODE.PORT``

    def key(self, plan: Plan) -> Hashable:
        return self, self._value(plan).key

    def answer(self, passing: Passing) -> CurveData | TableData:
        self._value(passing.plan)
        data: CurveData | TableData = passing.engine.value(passing.plan, self.port, passing.work)
        return data

    def _value(self, plan: Plan) -> Curve | Table:
        value: Any = plan.output(self.port)
        if not isinstance(value, Curve | Table):
            kind = getattr(value, "port_type", type(value).__name__)
            raise NetworkError(f"{self.port} is a {kind}: only curve and table are plotted")
        return value


_ALIKE = 0.999  # of one another, where one mark is enough


def _marks(chain: Chain, grid: Grid, line: Line) -> tuple[CurveMark, ...]:
    nyquist = line.end(grid.nyquist_x, grid.nyquist_y)
    pixels = line.end(*(math.inf if end is None else end for end in chain.pixel_nyquist))
    marks = [CurveMark("Nyquist", nyquist)]
    if pixels < _ALIKE * nyquist:
        marks = [CurveMark("samples' Nyquist", nyquist), CurveMark("pixels' Nyquist", pixels)]
    planar = (f for stage in chain.stages for f in stage.factors if isinstance(f, Planar))
    cutoffs = [cutoff for cutoff in map(_cutoff_along(line), planar) if cutoff]
    if cutoffs:
        marks.append(CurveMark("optics cutoff", min(cutoffs)))
    return tuple(marks)


def _cutoff_along(line: Line) -> Any:
    def cutoff(factor: Planar) -> float | None:
        if factor.cutoff is None:
            return None
        x, y = factor.cutoff
        if line.along == 0.0 or line.across == 0.0:
            return x if line.along == 0.0 else y
        # The OTF of a disc ends on an ellipse; where other shapes' do, their extents do not show.
        return 1.0 / math.hypot(line.across / x, line.along / y) if factor.radial else None

    return cutoff


def _missing(chain: Chain) -> str:
    return f"{chain.missing}; {HOW_TO_MARK}" if chain.choices else chain.missing


def _trouble(plan: Plan, further: tuple[str, ...]) -> str:
    texts = [error_text(error) for error in plan.errors()]
    texts += [text for text in further if text not in texts]
    if len(texts) > 1:
        return f"{texts[0]} (and {len(texts) - 1} more)"
    return texts[0] if texts else ""
