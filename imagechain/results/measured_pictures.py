"""What `imagechain.measure` gives: curves as arrays, edges and noise as plain values."""

from __future__ import annotations

import json
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from app.measure.measurement_files import measurement_json, write_measurement
from app.measure.measurement_text import figure_rows, refused_lines, remarks
from app.measure.measuring import without_edge
from app.measure.picture_measurement import (
    MeasuredEdge,
    NoiseFigures,
    PictureMeasurement,
)
from app.run.readout_tables import columns
from core.errors import ParameterError
from core.physics.measurement.edges.edge_mtf import MtfCurve
from imagechain.parts.plain_errors import plain_errors


class MeasuredPictures:
    """MTF, edges and noise of pictures.

    `x` and `y` are the pooled MTFs across and along, with `frequency` (cycles/sample), `mtf`,
    `sigma` (its standard error), `mtf50` and `mtf50_sigma`, or None, with the reason in
    `reason_x` and `reason_y`; `edges` all edges that were seen, each with `used`, `why_not`,
    `found` (place, angle, levels) and its own `curve`; `noise` has `sigma`, `sigma_error`,
    `gain_e_per_dn`, `read_noise_dn`.
    """

    def __init__(self, measured: PictureMeasurement) -> None:
        self._measured = measured

    @property
    def x(self) -> MtfCurve | None:
        """Pooled MTF across."""
        return self._measured.x

    @property
    def y(self) -> MtfCurve | None:
        """Pooled MTF along."""
        return self._measured.y

    @property
    def reason_x(self) -> str:
        """Why there is no MTF across; empty where there is."""
        return self._measured.reason_x

    @property
    def reason_y(self) -> str:
        """Why there is no MTF along; empty where there is."""
        return self._measured.reason_y

    @property
    def edges(self) -> tuple[MeasuredEdge, ...]:
        """All edges that were seen, used or not."""
        return self._measured.edges

    @property
    def noise(self) -> NoiseFigures | None:
        """Noise of flat areas; None where there are none, see `to_dict`."""
        return self._measured.noise

    @plain_errors
    def without(self, edge: int) -> MeasuredPictures:
        """The same without an edge, by its place in `edges`; this one stays as it is.

        Raises
        ------
        ParameterError
            There is no such edge.
        """
        many = len(self.edges)
        if not 0 <= edge < many:
            raise ParameterError("edge", edge, f"0 to {many - 1}" if many else "none: no edges")
        return MeasuredPictures(without_edge(self._measured, edge))

    def to_dict(self) -> dict[str, Any]:
        """Everything, as `imagechain measure --json` writes it."""
        content: dict[str, Any] = json.loads(measurement_json(self._measured))
        return content

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write everything (.json), the table of MTF for MTF File (.csv), or a page (.html).

        Raises
        ------
        ImagechainError
            Another suffix, no MTF for a table, or the file cannot be written.
        """
        file = Path(fspath(path))
        write_measurement(self._measured, file)
        return file

    def __repr__(self) -> str:
        lines = [columns(figure_rows(self._measured), right=(1,))]
        return "\n".join([*lines, *remarks(self._measured), *refused_lines(self._measured)])
