"""Pictures, read-outs, transfer functions and rows of a study, by name and as tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import copy
from itertools import islice
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from app.run.evaluation import Evaluation, ReadoutRow, block_means, each_readout
from app.run.saving import grey_png, metadata_of, save_array
from app.run.terminal import columns, jsonable, number_text, warned_points
from app.run.transfer_chain import StageCurve, responses_along
from core.chain.wires import Image
from core.errors import ParameterError, close, several, shown
from core.evaluation import recipes, work
from core.records import dataclass
from imagechain.parts.plain_errors import block, needed, plain_errors, png, stays_here, table, text

if TYPE_CHECKING:
    from pandas import DataFrame
    from xarray import DataArray

    from app.study.study_rows import StudyRows

Value = TypeVar("Value")
_SHOWN = 20  # rows of a notebook's table


class _Named(Mapping[str, Value]):
    """Values by name, given as copies."""

    def __init__(self, values: Mapping[str, Value]) -> None:
        self._values = dict(values)

    @plain_errors
    def __getitem__(self, name: str) -> Value:
        if name not in self._values:
            raise self._no(name)
        return copy(self._values[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def _no(self, name: str) -> Exception:
        raise NotImplementedError

    def _ipython_key_completions_(self) -> list[str]:
        return list(self)


class Images(_Named[NDArray[Any]]):
    """Samples of a result's pictures by port."""

    def __init__(self, ports: Iterable[str], image: Callable[[str], NDArray[Any]]) -> None:
        super().__init__(dict.fromkeys(ports, np.zeros(0)))
        self._image = image

    __reduce__ = stays_here

    def __getitem__(self, port: str) -> NDArray[Any]:
        return self._image(port)

    def __repr__(self) -> str:
        return f"<images: {', '.join(self)}>"


class ReadoutTable(_Named[Mapping[str, Any]]):
    """Read-outs as ``readouts[NODE][NAME]``; `rows` also gives units and meanings."""

    def __init__(self, evaluation: Evaluation) -> None:
        self.rows = tuple(each_readout(evaluation))
        super().__init__(evaluation.readouts)

    def _no(self, name: str) -> Exception:
        hint = close(name, self._values)
        return KeyError(f"there is no node {shown(name)} with read-outs{hint}")

    @plain_errors
    def row(self, name: str) -> ReadoutRow:
        """The read-out ``NODE.NAME`` with its unit and meaning."""
        names = [f"{row.node}.{row.name}" for row in self.rows]
        if name not in names:
            raise ParameterError(
                "read-out", name, f"the chain has no read-out of this name{close(name, names)}"
            )
        return self.rows[names.index(name)]

    def to_dict(self) -> dict[str, dict[str, Any]]:
        """Read-outs by node and name, as plain values; infinite values are strings."""
        plain: dict[str, dict[str, Any]] = jsonable(self._values)
        return plain

    @plain_errors
    def to_frame(self) -> DataFrame:
        """Return a pandas `DataFrame`: value, unit and meaning by node and read-out."""
        pandas = needed("pandas", "tables as DataFrames")
        places = [(row.node, row.name) for row in self.rows]
        index = pandas.MultiIndex.from_tuples(places, names=["node", "readout"])
        names = ("value", "unit", "meaning")
        cells = {name: [getattr(row, name) for row in self.rows] for name in names}
        frame: DataFrame = pandas.DataFrame(cells, index=index, dtype=object)
        return frame

    def __repr__(self) -> str:
        rows = [row.texts for row in self.rows if row.value is not None]
        return columns(rows, right=(2,)) or "no read-outs"

    def _repr_html_(self) -> str:
        return table(
            ("node", "read-out", "value", "unit"), [row.texts for row in self.rows], right=2
        )


class StageCurves(_Named[Mapping[str, StageCurve]]):
    """Curves as ``curves[STAGE][AXIS]``.

    Stages are nodes; ``"total"`` is the product of all stages before pixels are combined, and
    ``"total_with_electronics"`` also includes the later stages. The axes are ``"x"`` and ``"y"``,
    or only ``"line"`` if you gave ``angle_deg``.
    """

    def __init__(
        self, curves: Mapping[str, Mapping[str, StageCurve]], titles: Mapping[str, str], drawn: Any
    ) -> None:
        super().__init__(curves)
        self.titles = dict(titles)
        self._drawn = drawn

    __reduce__ = stays_here

    def _no(self, name: str) -> Exception:
        known = close(name, self) or f"; the stages are {', '.join(self) or 'none'}"
        return KeyError(f"the chain has no stage {shown(name)}{known}")

    @property
    def total(self) -> Mapping[str, StageCurve]:
        """The product of all stages, including electronics if there are any."""
        name = "total_with_electronics" if "total_with_electronics" in self._values else "total"
        return self[name]

    @plain_errors
    def to_frame(self) -> DataFrame:
        """Return a pandas `DataFrame`, with a row for each stage, axis and frequency."""
        rows = [
            (stage, axis, *numbers)
            for stage, axes in self._values.items()
            for axis, one in axes.items()
            for numbers in zip(one.frequency, one.mtf, one.ptf_rad, strict=True)
        ]
        names = ["stage", "axis", "frequency_cyc_per_mrad", "mtf", "ptf_rad"]
        return _frame({name: [row[place] for row in rows] for place, name in enumerate(names)})

    def to_png(self) -> bytes:
        """Return a plot of the MTFs as PNG, drawn as in a report."""
        import matplotlib  # noqa: F401  (first, so that it has the user's settings)

        return bytes(self._drawn())

    def __repr__(self) -> str:
        return f"<curves of {', '.join(self) or 'no stage'}>"

    def _repr_html_(self) -> str:
        return png(self.to_png(), alt="MTF of every stage") if self._values else text(repr(self))


def curves_of(evaluation: Evaluation, angle_deg: float | None = None) -> StageCurves:
    """Curves along both axes or a line; raises an error if a stage has no curve along the line."""
    chain = evaluation.chain
    if angle_deg is None:
        known = evaluation.responses
    else:
        known = responses_along(chain, evaluation.work, angle_deg)
        for error in known.failed:
            raise error
    stages = (*known.stages, *known.beside, *known.products)
    curves: dict[str, dict[str, StageCurve]] = {}
    for one in stages:
        curves[one.name] = {"x": one.x, "y": one.y} if angle_deg is None else {"line": one.x}
        for curve in curves[one.name].values():
            for array in (curve.frequency, curve.mtf, curve.ptf_rad):
                array.flags.writeable = False

    def drawn() -> bytes:
        from app.report.drawing.curves import line_png, stages_png

        if angle_deg is None:
            return stages_png(known, chain, "mtf")
        return line_png(known, angle_deg)

    return StageCurves(curves, {one.name: one.title for one in stages}, drawn)


class StudyTable(_Named[list[Any]]):
    """Columns by name, as ``rows["electronics.snr"]``: one value per point, in order.

    The columns are the varied parameters, the figures, ``point``, ``key`` (identifies the result),
    ``seconds``, ``error`` (empty if no figure or file is missing) and ``warnings``. `units` gives
    the unit of each column.
    """

    def __init__(self, rows: StudyRows) -> None:
        self._rows, self._columns = rows, rows.columns()
        super().__init__({column.name: list(column.values) for column in self._columns})
        self.units: dict[str, str] = {column.name: column.unit for column in self._columns}

    def _no(self, name: str) -> Exception:
        known = close(name, self) or f"; the columns are {', '.join(self)}"
        return ParameterError("column", name, f"the study has no column of this name{known}")

    @property
    def failed(self) -> dict[int, str]:
        """Errors of the failed points, by point number."""
        return {row.place + 1: row.error for row in self._rows.failed}

    @property
    def warnings(self) -> dict[int, tuple[str, ...]]:
        """Warnings from the nodes, by point number; points without warnings are left out."""
        return {row.place + 1: row.warnings for row in self._rows.rows if row.warnings}

    @plain_errors
    def to_frame(self) -> DataFrame:
        """Return a pandas `DataFrame`, with units in the column names."""
        return _frame({column.head: column.typed for column in self._columns})

    def _texts(self) -> tuple[list[str], list[list[str]], str]:
        """Heads, the first rows, and how many points there are and what they warn of."""
        first = islice(zip(*self._values.values(), strict=True), _SHOWN)
        rows = [
            [number_text(v) if isinstance(v, float) else "" if v is None else str(v) for v in row]
            for row in first
        ]
        every = self._rows.rows
        ends = [several(len(every), "point"), *warned_points([row.warnings for row in every])]
        return [column.head for column in self._columns], rows, "\n".join(ends)

    def __repr__(self) -> str:
        heads, rows, ends = self._texts()
        left = len(self._rows.rows) - len(rows)
        more = f"\nand {left} more" if left else ""
        return f"{columns([heads, *rows])}{more}\n{ends}"

    def _repr_html_(self) -> str:
        from app.study.study_drawing import study_png

        heads, rows, ends = self._texts()
        picture = png(study_png(self._rows), alt="figures of the study")
        return block(picture, table(heads, rows, caption=ends))


def _frame(columns: Mapping[str, Any]) -> DataFrame:
    frame: DataFrame = needed("pandas", "tables as DataFrames").DataFrame(columns)
    return frame


# One picture of a result: samples with their unit, interval and band.

_WIDEST = 640  # on a page
_MOST_PX = 1024


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture that a chain has computed, at a port ``NODE.PORT``.

    The samples are read-only, with the shape (rows, columns) or (frames, rows, columns). `unit` is
    the unit of the samples; `interval_mrad` is the horizontal and vertical sampling interval, mrad,
    with None if unknown; `band_um` is the cut-on and cut-off wavelength, µm, or None if unknown;
    `wavelengths_um` has the centre wavelengths of the bands, µm, and is empty if there are no
    separate bands.
    """

    port: str
    samples: NDArray[Any]
    unit: str
    interval_mrad: tuple[float | None, float | None]
    band_um: tuple[float, float] | None
    wavelengths_um: tuple[float, ...]
    _image: Image
    _work: work.Work
    _region: recipes.Region | None

    __reduce__ = stays_here

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the samples."""
        return self.samples.shape

    @plain_errors
    def band(self, index: int) -> NDArray[Any]:
        """Samples of one wavelength band, counted from 0; radiance is per µm."""
        bands = self._image.bands
        count = 0 if bands is None else bands.count
        if bands is None or not 0 <= index < count:
            allowed = f"0 to {count - 1}" if count else "the picture has no separate bands"
            raise ParameterError("band", index, allowed)
        samples = self._work.value(bands.band(index))
        samples = samples if self._region is None else self._region.cut(samples)
        samples.flags.writeable = False
        return samples.view()

    @plain_errors
    def cube(self) -> NDArray[Any]:
        """All wavelength bands in one array, (bands, rows, columns), each as `band` returns it."""
        return np.stack([self.band(index) for index in range(max(1, len(self.wavelengths_um)))])

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.array(self.samples, dtype=dtype, copy=copy)

    @plain_errors
    def to_xarray(self, *, bands: bool = False) -> DataArray:
        """Return a `DataArray` with y and x in mrad from the centre; unit and band are attributes.

        y increases downwards, as the rows do.

        Parameters
        ----------
        bands : bool
            Whether to return all bands, over wavelength (µm), y and x, instead of their sum.
        """
        xarray = needed("xarray", "pictures as DataArrays")
        image, region = self._image, self._region
        coordinates = {}
        parts = (slice(None), slice(None)) if region is None else region.slices
        intervals = image.interval_y_mrad, image.interval_x_mrad
        for axis, length, interval, part in zip("yx", image.shape, intervals, parts, strict=True):
            if interval is not None:
                places = (np.arange(length) - (length - 1) / 2.0) * interval
                coordinates[axis] = (axis, places[part], {"units": "mrad"})
        samples, unit = (self.cube() if bands else self.samples), self.unit
        if bands and image.bands is not None and image.bands.density:
            unit = f"{unit}/µm"
        attributes: dict[str, Any] = {"units": unit}
        for name, interval in zip(("x", "y"), self.interval_mrad, strict=True):
            if interval is not None:
                attributes[f"interval_{name}_mrad"] = interval
        if self.band_um is not None:
            attributes["band_um"] = list(self.band_um)
        if bands:
            units = {"units": "µm"}
            coordinates["wavelength"] = ("wavelength", np.array(self.wavelengths_um), units)
        first = "wavelength" if bands else "frame"
        dims = (first, "y", "x")[-samples.ndim :]
        array: DataArray = xarray.DataArray(
            samples, coordinates, dims, name=self.port, attrs=attributes
        )
        return array

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write the samples in the format of the file's suffix, with unit and field of view."""
        target = Path(fspath(path))
        samples = self.samples
        if samples.ndim == 3:
            raise ParameterError(
                "frames", len(samples), "save() writes one frame; run the chain with frames=1"
            )
        save_array(target, samples, metadata_of(self._image, samples.shape))
        return target

    def to_png(self, most_px: int | None = None) -> bytes:
        """Return the first frame as an 8-bit grey PNG, scaled to its 0.1 % to 99.9 % quantiles.

        Parameters
        ----------
        most_px : int, optional
            Largest number of rows or columns; larger pictures are reduced by averaging pixels.
        """
        samples = self.samples[0] if self.samples.ndim == 3 else self.samples
        if most_px is not None and max(samples.shape) > most_px:
            samples = block_means(samples, *(-(-side // most_px) for side in samples.shape))
        return grey_png(samples)

    def __repr__(self) -> str:
        size = " × ".join(map(str, self.shape))
        return f"<Picture {self.port}: {size} {self.samples.dtype}, {self.unit or 'no unit'}>"

    def _repr_html_(self) -> str:
        width = min(_WIDEST, self.samples.shape[-1])
        picture = png(self.to_png(_MOST_PX), alt=self.port, width=width)
        return block(picture, text(repr(self)[1:-1]))
