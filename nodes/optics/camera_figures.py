"""What follows of a camera's data sheet: angles, frequencies, distances on the ground."""

from __future__ import annotations

import math

from core.chain.results import CameraSheet, TableData, TableRow
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work

Band = tuple[float, float]


@ends_lineage
def camera_figures(
    work: Work,
    *,
    sheet: CameraSheet,
    interval_x_mrad: float | None,
    interval_y_mrad: float | None,
    band_um: Band | None,
) -> TableData:
    """The sheet and its figures as a table; what lacks a value is empty."""
    x, y = sheet.pitch_x_mrad, sheet.pitch_y_mrad
    middle = None if band_um is None else sum(band_um) / 2
    blur = _times(middle, sheet.f_number)
    return TableData(
        (
            TableRow("pixels_x", sheet.pixels_x, "pixels", "pixels across"),
            TableRow("pixels_y", sheet.pixels_y, "pixels", "pixels along"),
            TableRow("pitch_x_um", sheet.pitch_x_um, "µm", "from pixel to pixel across"),
            TableRow("pitch_y_um", sheet.pitch_y_um, "µm", "from pixel to pixel along"),
            TableRow("focal_length_mm", sheet.focal_length_mm, "mm", "focal length"),
            TableRow("f_number", sheet.f_number, "", "F-number"),
            TableRow("aperture_mm", sheet.aperture_mm, "mm", "diameter of the aperture"),
            TableRow("obscuration_ratio", sheet.obscuration_ratio, "", "inner over outer diameter"),
            TableRow("fill_x", sheet.fill_x or 1.0, "", "fill factor across"),
            TableRow("fill_y", sheet.fill_y or 1.0, "", "fill factor along"),
            TableRow("range_m", sheet.range_m, "m", "distance of the scene"),
            TableRow("pixel_x_mrad", x, "mrad", "from pixel to pixel across"),
            TableRow("pixel_y_mrad", y, "mrad", "from pixel to pixel along"),
            TableRow("fov_x_deg", _deg(_times(sheet.pixels_x, x)), "deg", "all pixels across"),
            TableRow("fov_y_deg", _deg(_times(sheet.pixels_y, y)), "deg", "all pixels along"),
            TableRow("nyquist_x", _over(0.5, x), "cyc/mrad", "Nyquist frequency across"),
            TableRow("nyquist_y", _over(0.5, y), "cyc/mrad", "Nyquist frequency along"),
            TableRow("samples_per_pixel_x", _over(x, interval_x_mrad), "samples", "across"),
            TableRow("samples_per_pixel_y", _over(y, interval_y_mrad), "samples", "along"),
            TableRow("cutoff", _over(sheet.aperture_mm, middle), "cyc/mrad", "of diffraction"),
            TableRow("q", _over(blur, sheet.pitch_x_um), "", "λF/pitch at the band's middle"),
            TableRow("gsd_x_m", _km(_times(x, sheet.range_m)), "m", "seen by a pixel across"),
            TableRow("gsd_y_m", _km(_times(y, sheet.range_m)), "m", "seen by a pixel along"),
        )
    )


def _times(a: float | None, b: float | None) -> float | None:
    return None if a is None or b is None else a * b


def _over(a: float | None, b: float | None) -> float | None:
    return None if a is None or not b else a / b


def _deg(mrad: float | None) -> float | None:
    return None if mrad is None else math.degrees(mrad / 1000.0)


def _km(mrad_m: float | None) -> float | None:
    """Milliradians times metres as metres."""
    return None if mrad_m is None else mrad_m / 1000.0
