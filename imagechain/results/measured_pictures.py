"""The result of `imagechain.measure`: curves as arrays, edges and noise as plain values."""

from __future__ import annotations

import json
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from app.measure.measurement_files import measurement_json, write_measurement
from app.measure.measurement_text import figure_rows, refused_lines, remarks
from app.measure.measuring import without_edge
from app.measure.picture_measurement import MeasuredEdge, NoiseFigures, PictureMeasurement
from app.run.readout_tables import columns
from core.errors import ParameterError
from core.physics.measurement.edges.edge_mtf import MtfCurve
from imagechain.parts.plain_errors import plain_errors


class MeasuredPictures:
    """MTF, edges and noise of pictures.

    `x` and `y` are the pooled horizontal and vertical MTFs, with `frequency` (cycles/sample),
    `mtf`, `sigma` (its standard error), `mtf50` and `mtf50_sigma`. They are None if there is no
    MTF; `reason_x` and `reason_y` say why. `edges` lists all edges that were found, each with
    `used`, `why_not`, `found` (place, angle, levels) and its own `curve`. `noise` has `sigma`,
    `sigma_error`, `gain_e_per_dn` and `read_noise_dn`.
    """

    def __init__(self, measured: PictureMeasurement) -> None:
        self._measured = measured

    @property
    def x(self) -> MtfCurve | None:
        """Pooled horizontal MTF."""
        return self._measured.x

    @property
    def y(self) -> MtfCurve | None:
        """Pooled vertical MTF."""
        return self._measured.y

    @property
    def reason_x(self) -> str:
        """Why there is no horizontal MTF; empty if there is one."""
        return self._measured.reason_x

    @property
    def reason_y(self) -> str:
        """Why there is no vertical MTF; empty if there is one."""
        return self._measured.reason_y

    @property
    def edges(self) -> tuple[MeasuredEdge, ...]:
        """All edges that were found, used or not."""
        return self._measured.edges

    @property
    def noise(self) -> NoiseFigures | None:
        """Noise of flat areas; None if there are none, see `to_dict`."""
        return self._measured.noise

    @plain_errors
    def without(self, edge: int) -> MeasuredPictures:
        """Return the result without one edge, by its index in `edges`; this one does not change.

        Raises
        ------
        ParameterError
            If there is no such edge.
        """
        many = len(self.edges)
        if not 0 <= edge < many:
            raise ParameterError("edge", edge, f"0 to {many - 1}" if many else "there are no edges")
        return MeasuredPictures(without_edge(self._measured, edge))

    def to_dict(self) -> dict[str, Any]:
        """The whole result as a dictionary, like the JSON of `imagechain measure --json`."""
        content: dict[str, Any] = json.loads(measurement_json(self._measured))
        return content

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write everything (.json), an MTF table for MTF File (.csv), or a page (.html).

        Raises
        ------
        ImagechainError
            If the suffix is not supported, no MTF was measured for a table, or the file cannot be
            written.
        """
        file = Path(fspath(path))
        write_measurement(self._measured, file)
        return file

    def __repr__(self) -> str:
        lines = [columns(figure_rows(self._measured), right=(1,))]
        return "\n".join([*lines, *remarks(self._measured), *refused_lines(self._measured)])
