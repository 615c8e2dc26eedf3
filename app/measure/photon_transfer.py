"""Gain, noise and full well of a camera from its flat fields: the photon transfer curve."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.run.readout_tables import columns, json_text, number_text
from core.errors import in_line
from core.physics.measurement.photon_transfer import (
    FlatField,
    FlatFrames,
    PhotonTransfer,
    photon_transfer,
)
from nodes.files.common.file_format import JSON
from nodes.files.common.table_cells import csv_lines
from nodes.files.frames import FrameFile, check_one_camera, open_frames

_MOSTLY = 0.5  # of the fixed pattern, from which on that is the field's more than the pixels'


_LEVEL_HEAD = ("file", "frames", "mean (DN)", "temporal σ² (DN²)", "fixed σ² (DN²)", "")


def transfer_rows(curve: PhotonTransfer) -> list[tuple[str, float | None, str, str]]:
    emva, ratio = curve.emva, None
    if curve.full_well_e and curve.read_noise_e:
        ratio = curve.full_well_e / curve.read_noise_e
    return [
        ("gain_e_per_dn", curve.gain_e_per_dn, "e-/DN", "electrons per digital number"),
        ("gain_error", curve.gain_error, "e-/DN", "standard error of the gain"),
        ("offset_dn", curve.offset_dn, "DN", "digital number at zero electrons"),
        ("read_noise_e", curve.read_noise_e, "e-", "temporal noise in the dark, without "
                                                   "rounding noise"),
        ("read_noise_error", curve.read_noise_error, "e-", "standard error of the read noise"),
        ("full_well_e", curve.full_well_e, "e-", "level of saturation"),
        ("brightest_e", curve.brightest_e, "e-", "the brightest level"),
        ("dynamic_range_dB", _decibels(ratio), "dB", "full well divided by read noise"),
        ("dsnu_e", curve.dsnu_e, "e-", "fixed-pattern noise in the dark"),
        ("prnu_percent", curve.prnu_percent, "%", "fixed-pattern noise proportional to the signal"),
        # Where EMVA 1288 defines a figure otherwise, or has one more.
        ("system_gain_dn_per_e", emva.system_gain_dn_per_e, "DN/e-", "K of EMVA 1288: 1/gain"),
        ("saturation_capacity_e", emva.saturation_capacity_e, "e-",
         "µe.sat of EMVA 1288: level with the largest temporal variance"),
        ("sensitivity_threshold_e", emva.sensitivity_threshold_e, "e-",
         "µe.min of EMVA 1288: signal at SNR 1"),
        ("emva_dynamic_range_dB", _decibels(emva.dynamic_range), "dB", "µe.sat divided by µe.min"),
        ("snr_max_dB", _decibels(emva.snr_max), "dB", "√µe.sat"),
        ("dsnu_row_e", emva.dsnu_row_e, "e-", "DSNU of whole rows"),
        ("dsnu_column_e", emva.dsnu_column_e, "e-", "DSNU of whole columns"),
        ("dsnu_pixel_e", emva.dsnu_pixel_e, "e-", "DSNU of single pixels"),
        ("prnu_row_percent", emva.prnu_row_percent, "%", "PRNU of whole rows"),
        ("prnu_column_percent", emva.prnu_column_percent, "%", "PRNU of whole columns"),
        ("prnu_pixel_percent", emva.prnu_pixel_percent, "%", "PRNU of single pixels"),
    ]  # fmt: skip


def _decibels(ratio: float | None) -> float | None:
    return 20.0 * math.log10(ratio) if ratio else None


@dataclass(frozen=True)
class TransferMeasurement:
    """The flat fields of a camera, and what their curve gives."""

    files: tuple[tuple[Path, FlatField], ...]
    dark: Path | None
    curve: PhotonTransfer

    def lines(self) -> list[str]:
        figures = [
            (name, number_text(value), unit, meaning)
            for name, value, unit, meaning in transfer_rows(self.curve)
        ]
        return [
            columns(figures, right=(1,)) + "\n",
            columns([_LEVEL_HEAD, *self._levels()], right=(1, 2, 3, 4)),
            *map(in_line, (*self._remarks(), *self._textures())),
        ]

    def _levels(self) -> list[tuple[str, ...]]:
        states = zip(self.curve.used, self.curve.saturated, strict=True)
        return [
            (
                path.name,
                str(field.frames),
                number_text(field.mean_dn),
                number_text(field.temporal_dn2),
                number_text(field.fixed_dn2),
                "saturated" if saturated else "" if used else "not used for the fit",
            )
            for (path, field), (used, saturated) in zip(self.files, states, strict=True)
        ]

    def _remarks(self) -> list[str]:
        curve, lines = self.curve, []
        if curve.dark_cut_off:
            lines.append(
                f"{self.dark}: the noise reaches 0, where the converter clips it, so these dark "
                "frames are not used; raise the camera's offset, or give --offset-dn"
            )
        elif curve.offset_dn is None:
            lines.append("read noise and full well need --dark FILE, or --offset-dn DN")
        if curve.offset_dn is not None and curve.full_well_e is None:
            lines.append(
                "no level is saturated: the full well is above the brightest level; "
                "add a brighter level"
            )
        return lines

    def _textures(self) -> list[str]:
        """Fields of which more is structure than pixels that differ; saturated ones say nothing."""
        return [
            f"warning: {path.name}: {100.0 * field.structure_share:.0f} % of the differences "
            "between pixels is structure of 8 pixels or more, as in a scene or uneven light: PRNU "
            "and DSNU include it; give frames of a uniform field"
            for (path, field), saturated in zip(self.files, self.curve.saturated, strict=True)
            if field.structure_share > _MOSTLY and not saturated
        ]

    def content(self, path: Path) -> str:
        return json_text(self.facts()) if JSON.matches(path) else self._csv()

    def facts(self) -> dict[str, Any]:
        return {
            "format": "imagechain-photon-transfer",
            "version": 1,
            "figures": {name: value for name, value, _, _ in transfer_rows(self.curve)},
            "dark_cut_off": self.curve.dark_cut_off,
            "levels": [
                {
                    "file": str(path),
                    "frames": field.frames,
                    "mean_dn": field.mean_dn,
                    "temporal_dn2": field.temporal_dn2,
                    "fixed_dn2": field.fixed_dn2,
                    "pixels": field.pixels,
                    "bad_pixels": field.bad,
                    "structure_share": field.structure_share,
                    "used": used,
                    "saturated": saturated,
                }
                for (path, field), used, saturated in zip(
                    self.files, self.curve.used, self.curve.saturated, strict=True
                )
            ],
        }

    def _csv(self) -> str:
        rows = [("name", "value", "unit", "meaning")]
        for name, value, unit, meaning in transfer_rows(self.curve):
            rows.append((name, "" if value is None else repr(value), unit, meaning))
        for path, field in self.files:
            rows.append((f"{path.name}: mean_dn", repr(field.mean_dn), "DN", "mean of a level"))
            meaning = "temporal variance of a level"
            rows.append((f"{path.name}: temporal_dn2", repr(field.temporal_dn2), "DN²", meaning))
        return csv_lines(rows)


def measured_transfer(
    flats: Sequence[Path],
    dark: Path | None,
    offset_dn: float | None,
    *,
    check: Callable[[], None],
    report: Callable[[str], object],
) -> TransferMeasurement:
    """The curve of one camera's flat fields; the dark level from dark frames, or as it is given."""

    def field(file: FrameFile) -> FlatField:
        report(file.path.name)
        taken = FlatFrames(file.rows, file.columns)
        for frame in file.each():
            check()
            taken.add(frame)
        return taken.measured()

    files = [open_frames(path) for path in (*flats, *filter(None, [dark]))]
    check_one_camera(files, of_one="a flat field")
    fields = [field(file) for file in files]
    levels = fields[: len(flats)]
    dark_field = None if dark is None else fields[-1]
    curve = photon_transfer(levels=levels, dark=dark_field, offset_dn=offset_dn)
    return TransferMeasurement(tuple(zip(flats, levels, strict=True)), dark, curve)
