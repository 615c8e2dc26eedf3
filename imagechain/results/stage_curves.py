"""Transfer functions of a result: every stage, and their product."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from app.run.evaluation import Evaluation
from app.run.responses import Response, responses_along
from core.names import close, shown
from imagechain.parts.plain_errors import (
    needed,
    plain_errors,
    png,
    stays_here,
    text,
    users_matplotlib,
)

if TYPE_CHECKING:
    from pandas import DataFrame

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class StageCurve:
    """MTF (signed) and PTF (rad) of a stage along one axis; `frequency` in cycles/mrad."""

    frequency: Vector = field(repr=False)
    mtf: Vector = field(repr=False)
    ptf_rad: Vector = field(repr=False)

    @property
    def otf(self) -> NDArray[np.complex128]:
        """MTF and PTF as one complex function."""
        return np.asarray(self.mtf * np.exp(1j * self.ptf_rad), np.complex128)


class StageCurves(Mapping[str, Mapping[str, StageCurve]]):
    """Curves as ``curves[STAGE][AXIS]``.

    Stages are nodes; ``"total"`` is their product before pixels are combined, and
    ``"total_with_electronics"`` also includes what follows. Axes are ``"x"`` and ``"y"``, or
    ``"line"``.
    """

    def __init__(
        self, curves: Mapping[str, Mapping[str, StageCurve]], titles: Mapping[str, str], drawn: Any
    ) -> None:
        self._curves = {name: dict(axes) for name, axes in curves.items()}
        self.titles = dict(titles)
        self._drawn = drawn

    __reduce__ = stays_here

    @plain_errors
    def __getitem__(self, stage: str) -> Mapping[str, StageCurve]:
        if stage not in self._curves:
            known = close(stage, self._curves) or f"; it has {', '.join(self._curves) or 'none'}"
            raise KeyError(f"the chain has no stage {shown(stage)}{known}")
        return dict(self._curves[stage])

    def __iter__(self) -> Iterator[str]:
        return iter(self._curves)

    def __len__(self) -> int:
        return len(self._curves)

    @property
    def total(self) -> Mapping[str, StageCurve]:
        """The product of all stages, electronics included where there are any."""
        name = "total_with_electronics" if "total_with_electronics" in self._curves else "total"
        return self[name]

    @plain_errors
    def to_frame(self) -> DataFrame:
        """Return a pandas `DataFrame`, with a row for each stage, axis and frequency.

        Raises
        ------
        UsageError
            If pandas is not installed.
        """
        pandas = needed("pandas", "tables as DataFrames")
        every = [
            (stage, axis, curve)
            for stage, axes in self._curves.items()
            for axis, curve in axes.items()
        ]
        lengths = [len(curve.frequency) for _, _, curve in every]
        frame: DataFrame = pandas.DataFrame(
            {
                "stage": np.repeat([stage for stage, _, _ in every], lengths),
                "axis": np.repeat([axis for _, axis, _ in every], lengths),
                "frequency_cyc_per_mrad": _joined([curve.frequency for _, _, curve in every]),
                "mtf": _joined([curve.mtf for _, _, curve in every]),
                "ptf_rad": _joined([curve.ptf_rad for _, _, curve in every]),
            }
        )
        return frame

    def to_png(self) -> bytes:
        """Plot the MTFs, as in a report."""
        users_matplotlib()
        drawing: bytes = self._drawn()
        return drawing

    def __repr__(self) -> str:
        return f"<curves of {', '.join(self) or 'no stage'}>"

    def _repr_html_(self) -> str:
        return png(self.to_png(), alt="MTF of every stage") if self._curves else text(repr(self))

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)


def curves_of(evaluation: Evaluation) -> StageCurves:
    """Curves along both axes."""
    known = evaluation.responses
    stages = (*known.stages, *known.beside, *known.products)
    curves = {
        stage.name: {"x": _curve(known.xi, stage.x), "y": _curve(known.eta, stage.y)}
        for stage in stages
    }

    def drawn() -> bytes:
        from app.report.drawing.curves import stages_png

        return stages_png(known, evaluation.chain, "mtf")

    return StageCurves(curves, {stage.name: stage.title for stage in stages}, drawn)


def curves_along(evaluation: Evaluation, angle_deg: float) -> StageCurves:
    """Curves along a line; raises the error of a stage that cannot be evaluated."""
    known = responses_along(evaluation.chain, evaluation.work, angle_deg)
    if known.failed:
        raise known.failed[0]
    stages = (*known.stages, *known.beside, *known.products)
    curves = {stage.name: {"line": _curve(known.frequency, stage.response)} for stage in stages}

    def drawn() -> bytes:
        from app.report.drawing.curves import line_png

        return line_png(known, angle_deg)

    return StageCurves(curves, {stage.name: stage.title for stage in stages}, drawn)


def _curve(frequency: Vector, response: Response) -> StageCurve:
    values = (frequency, response.mtf, response.ptf)
    for array in values:
        array.flags.writeable = False
    return StageCurve(*values)


def _joined(arrays: list[Vector]) -> Vector:
    return np.concatenate(arrays) if arrays else np.zeros(0)
