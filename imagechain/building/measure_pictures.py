"""Measure edges, MTF and noise of pictures, from files or arrays."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.measure.measurement_files import measurement_json, write_measurement
from app.measure.measurement_text import figure_rows, refused_lines, remarks
from app.measure.measuring import (
    MeasurePlan,
    Source,
    checked_pitch,
    measure_files,
    measure_pictures,
    without_edge,
)
from app.measure.picture_loading import NO_DATA, limits_of
from app.measure.picture_measurement import (
    MeasuredFile,
    PictureMeasurement,
)
from app.run.readout_tables import columns
from core.errors import DataError, ParameterError, UsageError
from core.physics.sampling.detector_sampling import interval_mrad
from imagechain.parts.plain_errors import plain_errors


class MeasuredPictures:
    """MTF, edges and noise of pictures.

    `x` and `y` are the pooled horizontal and vertical MTFs, with `frequency` (cycles/sample),
    `mtf`, `sigma` (its standard error), `mtf50` and `mtf50_sigma`. Each is None if it could not be
    measured; `reason_x` and `reason_y` say why. `edges` lists all edges that were found, each with
    `used`, `why_not`, `found` (place, angle, levels) and its own `curve`. `noise`, measured in flat
    areas, has `sigma`, `sigma_error`, `gain_e_per_dn` and `read_noise_dn`; it is None if the noise
    could not be measured.
    """

    def __init__(self, measured: PictureMeasurement) -> None:
        self._measured = measured
        self.x, self.y = measured.x, measured.y
        self.reason_x, self.reason_y = measured.reason_x, measured.reason_y
        self.edges, self.noise = measured.edges, measured.noise

    @plain_errors
    def without(self, edge: int) -> MeasuredPictures:
        """Return a copy of the result without one edge, given by its index in `edges`."""
        many = len(self.edges)
        if not 0 <= edge < many:
            raise ParameterError("edge", edge, f"0 to {many - 1}" if many else "there are no edges")
        return MeasuredPictures(without_edge(self._measured, edge))

    def to_dict(self) -> dict[str, Any]:
        """The complete result as a dictionary, like the JSON of `imagechain measure --json`."""
        content: dict[str, Any] = json.loads(measurement_json(self._measured))
        return content

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write all results (.json), an MTF table for MTF File (.csv), or a report (.html)."""
        file = Path(fspath(path))
        write_measurement(self._measured, file)
        return file

    def __repr__(self) -> str:
        lines = [columns(figure_rows(self._measured), right=(1,))]
        return "\n".join([*lines, *remarks(self._measured), *refused_lines(self._measured)])


File = str | PathLike[str]


@plain_errors
def measure(
    *pictures: File | NDArray[Any],
    band: int | None = None,
    fov_x_deg: float | None = None,
    pitch_um: float | None = None,
    offset_dn: float | None = None,
    dark: File | None = None,
) -> MeasuredPictures:
    """Measure edges, MTF and noise of one camera's pictures, as `imagechain measure` does.

    Parameters
    ----------
    pictures : path or array_like
        Files of pictures or frames; or arrays, (rows, columns) or (frames, rows, columns). All must
        have the same size.
    band : int, optional
        Band or colour to measure in files that have several, counted from 0.
    fov_x_deg : float, optional
        Horizontal field of view, degrees, instead of the value in the files.
    pitch_um : float, optional
        Pixel pitch, µm, for frequencies in cycles/mm.
    offset_dn : float, optional
        Digital number without light, for the read noise; by default 0.
    dark : path, optional
        File of dark frames, instead of `offset_dn`.
    """
    if not pictures:
        raise UsageError("measure needs a picture: give a file or an array")
    plan = MeasurePlan(
        (), band, fov_x_deg, None if dark is None else Path(fspath(dark)), offset_dn, pitch_um
    )
    if all(isinstance(one, str | PathLike) for one in pictures):
        paths = tuple(Path(fspath(one)) for one in pictures)  # type: ignore[arg-type]
        return MeasuredPictures(measure_files(replace(plan, pictures=paths)))
    if plan.dark is not None or band is not None:
        raise UsageError("band and dark apply to files only, not to arrays")
    measured = _of_arrays(pictures, fov_x_deg, offset_dn)
    return MeasuredPictures(replace(measured, pitch_um=checked_pitch(pitch_um, "pitch_um")))


def _of_arrays(
    pictures: Sequence[Any], fov_x_deg: float | None, offset_dn: float | None
) -> PictureMeasurement:
    taken = frames_of_arrays(pictures)
    frames = [frame for own in taken for frame in own]
    files = [MeasuredFile(f"array {n}", len(own), "") for n, own in enumerate(taken, 1)]
    shapes = {frame.shape for frame in frames}
    if len(shapes) > 1:
        raise DataError(
            f"all pictures must have the same size, but their sizes are {sorted(shapes)}"
        )
    rows, columns = frames[0].shape
    interval = None
    if fov_x_deg is not None:
        interval = interval_mrad(fov_deg=fov_x_deg, samples=columns, name="fov_x_deg")
    limits = limits_of_arrays(pictures)
    source = Source(
        tuple(files), frames, rows, columns, "", interval, interval, limits, offset_dn=offset_dn
    )
    return measure_pictures(source)


# Pictures of a camera that are given as arrays.

_FRAMES = 3  # dimensions


def frames_of_arrays(pictures: Sequence[Any]) -> list[list[NDArray[np.float64]]]:
    """The frames of each array, (rows, columns) or (frames, rows, columns), in double precision."""
    return [_frames(np.asarray(picture), number) for number, picture in enumerate(pictures, 1)]


def limits_of_arrays(pictures: Sequence[Any]) -> tuple[float, float] | None:
    """Smallest and largest number of the integer type, if all arrays have the same type."""
    ends = {limits_of(np.asarray(picture).dtype) for picture in pictures}
    return ends.pop() if len(ends) == 1 else None


def _frames(array: NDArray[Any], number: int) -> list[NDArray[np.float64]]:
    if array.dtype.kind not in "buif" or array.ndim not in (2, _FRAMES) or 0 in array.shape:
        raise DataError(
            f"picture {number} is an array of {array.dtype} with shape {array.shape}; allowed: "
            "real numbers, (rows, columns) or (frames, rows, columns)"
        )
    if not np.isfinite(array).all():
        raise DataError(f"picture {number} has samples that are not finite; {NO_DATA}")
    own = [*array] if array.ndim == _FRAMES else [array]
    return [np.asarray(frame, np.float64) for frame in own]
