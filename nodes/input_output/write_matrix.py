"""Write Matrix: samples, curves or a transfer function as plain text."""

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.chain.engine import realize
from core.chain.wires import Curve, CurveData, Image, Transfer
from core.errors import ParameterError
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext, param
from nodes.files.arrays import write_curves, write_matrix
from nodes.files.file_format import CSV, suffixes
from nodes.files.formats import MATRICES

Files = list[tuple[Path, Callable[[Path], None]]]
_SUFFIXES = suffixes(*MATRICES)


class WriteMatrix(
    Module, key="write_matrix", title="Write Matrix", group="Input and output", sink=True
):
    """Write values as plain text, one row per line, readable by MathCad's READPRN.

    A .csv file separates values with commas and names the columns of curves; .txt and .prn files
    use spaces. For bar charts, the first column holds the names of the bars in a .csv file, and
    their numbers, counted from 0, in other files. A transfer function is written in FFT order, zero
    frequency first. Files are written when a run saves its outputs, as for Write Image.
    """

    without_formula = "Write Matrix writes numbers unchanged."

    renamed = MappingProxyType({"curve": "image", "transfer": "image"})

    path: Path | None = param(None, "file to write, relative to the network file's folder")

    def run(self, image: Image | Curve | Transfer, here: NodeContext) -> None:
        self.target(here)

    def target(self, here: NodeContext) -> Path:
        if self.path is None:
            allowed = "a file name, relative to the network file's folder"
            raise ParameterError("path", None, allowed)
        if self.path.suffix.lower() not in _SUFFIXES:
            allowed = f"a name that ends in {', '.join(_SUFFIXES)}"
            raise ParameterError("path", self.path.as_posix(), allowed)
        return here.folder / self.path

    def files(self, inputs: Mapping[str, Any], here: NodeContext, work: Work) -> Files:
        target = self.target(here)
        value = realize(inputs["image"], work)
        if not isinstance(value, CurveData):
            return [(target, partial(write_matrix, array=value))]
        columns = curve_columns(value)
        if CSV.matches(target):
            return [(target, partial(write_curves, curves=value, columns=columns))]
        matrix = np.stack(list(columns.values()), axis=1)
        return [(target, partial(write_matrix, array=matrix))]


def curve_columns(curves: CurveData) -> dict[str, NDArray[np.float64]]:
    """Columns of equal length for curves, by unique names.

    One abscissa where all share it; else pairs of columns where all are equally long; else one
    curve below the other, with its number in the first column.
    """
    series = curves.series
    columns: dict[str, NDArray[np.float64]] = {}
    if series and all(np.array_equal(curve.x, series[0].x) for curve in series):
        columns[_name(curves.x_label, columns)] = series[0].x
        for curve in series:
            columns[_name(curve.label or curves.y_label, columns)] = curve.y
        return columns
    if series and len({len(curve.x) for curve in series}) == 1:
        for curve in series:
            columns[_name(f"{curve.label}: {curves.x_label}", columns)] = curve.x
            columns[_name(curve.label, columns)] = curve.y
        return columns
    numbers = [np.full(len(curve.x), float(n)) for n, curve in enumerate(series, 1)]
    columns["curve"] = np.concatenate([*numbers, np.empty(0)])
    columns[_name(curves.x_label, columns)] = np.concatenate([*(s.x for s in series), np.empty(0)])
    columns[_name(curves.y_label, columns)] = np.concatenate([*(s.y for s in series), np.empty(0)])
    return columns


def _name(wanted: str, taken: Mapping[str, object]) -> str:
    """`wanted` without the signs that end a name in CSV, numbered if it is taken."""
    plain = " ".join(wanted.replace(",", ";").replace('"', "'").split()) or "value"
    name, number = plain, 2
    while name in taken:
        name, number = f"{plain} ({number})", number + 1
    return name
