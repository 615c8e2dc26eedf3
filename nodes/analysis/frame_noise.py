"""Noise measured from simulated frames, beside the noise predicted from the chain."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.chain.frame_sequence import at_frame
from core.chain.results import CurveData, Series, TableData, TableRow
from core.evaluation.recipes import Recipe, ends_lineage
from core.evaluation.work import Work
from core.physics.noise.noise_components import COMPONENTS, MeasuredNoise, NoiseCube, NoiseVariances
from nodes.analysis.lineage import ImageNoise

MEANINGS = {
    "tvh": "random from sample to sample and frame to frame",
    "vh": "fixed from sample to sample",
    "v": "fixed from row to row",
    "h": "fixed from column to column",
    "t": "of whole frames from one to the next",
    "tv": "of rows from frame to frame",
    "th": "of columns from frame to frame",
}


@dataclass(frozen=True, eq=False)
class FrameNoise(Recipe):
    """Measures the components of a picture's noise over its first frames, against `clean`."""

    picture: Recipe
    clean: Recipe
    frames: int
    node: str | None = field(default=None, compare=False)

    def _content(self) -> tuple[object, ...]:
        return self.picture.key, self.clean.key, self.frames

    @property
    def inputs(self) -> tuple[Recipe, ...]:
        """The first frame, and what it is compared with."""
        return self.picture, self.clean

    @property
    def needs(self) -> tuple[Recipe, ...]:
        """The next frame too, which shares with the first all that leads to the noise."""
        return (*self.inputs, at_frame(self.picture, 1))

    def compute(self, work: Work) -> MeasuredNoise:
        """Take the frames one after the other; none is kept."""
        clean = np.asarray(work.value(self.clean), np.float64)
        cube = NoiseCube(*clean.shape)
        frames = (at_frame(self.picture, frame) for frame in range(self.frames))
        for picture in work.one_by_one(frames):
            work.check()
            cube.add(picture - clean)
        return cube.measured()


@ends_lineage
def table_of(
    work: Work,
    predicted: ImageNoise | None,
    measured: MeasuredNoise | None = None,
    *,
    unit: str,
) -> TableData:
    """Each component predicted and measured, with the standard error of what was measured."""
    rows = []
    expected = _expected(predicted)
    for name in COMPONENTS:
        meaning = f"noise {MEANINGS[name]}"
        if expected is not None:
            value = expected.sigma(name)
            rows.append(TableRow(f"sigma_{name}", value, unit, f"{meaning}, predicted"))
        if measured is not None:
            value, error = measured.variances.sigma(name), measured.errors.variance(name)
            rows.append(TableRow(f"sigma_{name}_measured", value, unit, f"{meaning}, measured"))
            # The error of a root by that of its square; of one next to nothing the root of it.
            spread = error / (2.0 * abs(value)) if value * value > error else error**0.5
            rows.append(TableRow(f"sigma_{name}_error", spread, unit, "standard error of it"))
    if expected is not None:
        rows += [
            TableRow("temporal", expected.temporal**0.5, unit, "temporal noise, predicted"),
            TableRow("fixed", expected.fixed**0.5, unit, "fixed-pattern noise, predicted"),
        ]
    if measured is not None:
        of_time, fixed = measured.variances.temporal, measured.variances.fixed
        rows += [
            TableRow("temporal_measured", max(of_time, 0.0) ** 0.5, unit, "temporal noise"),
            TableRow("fixed_measured", max(fixed, 0.0) ** 0.5, unit, "fixed-pattern noise"),
        ]
    if predicted is not None:
        rows.append(TableRow("mean", predicted.mean, unit, "mean of the picture without noise"))
    elif measured is not None:
        rows += [
            TableRow("mean", measured.mean, unit, "mean of all frames"),
            TableRow("frames", measured.frames, "", "frames of the file"),
        ]
    return TableData(tuple(rows))


def _expected(predicted: ImageNoise | None) -> NoiseVariances | None:
    if predicted is None:
        return None
    predicted.require_known()
    return predicted.total.variances


@ends_lineage
def bars_of(
    work: Work,
    predicted: ImageNoise | None,
    measured: MeasuredNoise | None = None,
    *,
    unit: str,
) -> CurveData:
    """The seven components as bars; those estimated below zero are drawn at zero."""
    expected = _expected(predicted)
    places = np.arange(float(len(COMPONENTS)))

    def heights(variances: NoiseVariances) -> NDArray[np.float64]:
        return np.array([max(variances.sigma(name), 0.0) for name in COMPONENTS])

    series = []
    if expected is not None:
        series.append(Series("predicted", places, heights(expected)))
    if measured is not None:
        series.append(Series("measured", places, heights(measured.variances)))
    names = tuple(f"σ {name}" for name in COMPONENTS)
    return CurveData(
        "Noise components", "component", f"σ ({unit})" if unit else "σ", tuple(series), bars=names
    )


@ends_lineage
def sigma_of(work: Work, table: TableData, *, name: str) -> float | None:
    """A figure of the table, None where it was not measured."""
    value = table.as_dict().get(name)
    return None if value is None else float(value)
