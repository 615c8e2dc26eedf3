"""Gain, noise, full well and NETD of a camera from frames of uniform fields."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.run.terminal import columns, json_text, number_text, values_of
from core.errors import DataError, in_line
from core.physics.measurement import thermal_response as thermal
from core.physics.measurement.photon_transfer import (
    FlatField,
    FlatFrames,
    PhotonTransfer,
    photon_transfer,
)
from core.physics.noise.noise_components import COMPONENTS, NoiseCube
from core.records import dataclass
from nodes.files import file_format, table_cells
from nodes.files.frames import FrameFile, check_one_camera, open_frames

_MOSTLY = 0.5  # of the fixed pattern, from which on that is the field's more than the pixels'
Row = tuple[str, float | None, str, str]
"""Name, value, unit and meaning of a figure."""


@dataclass(frozen=True)
class UniformFields:
    """What frames of uniform fields have given, for the terminal and for files."""

    figures: Sequence[Row]
    digits: int  # of figures in the terminal
    levels: Sequence[tuple[str, ...]]  # a row for each field, below its heads
    right: Sequence[int]  # columns of these that end together
    remarks: Sequence[str]
    facts: Mapping[str, Any]
    table: Sequence[Row]  # of each field, for CSV

    def lines(self) -> list[str]:
        figures = []
        for name, value, *rest in self.figures:
            shown = None if value is None else float(f"{value:.{self.digits}g}")
            figures.append((name, number_text(shown), *rest))
        levels = columns(self.levels, right=self.right)
        return [columns(figures, right=(1,)) + "\n", levels, *map(in_line, self.remarks)]

    def content(self, path: Path) -> str:
        if file_format.JSON.matches(path):
            return json_text(self.facts)
        return table_cells.csv_figures((*self.figures, *self.table))


# Gain, noise and full well from flat fields.

_OF_LEVEL = ("frames", "mean_dn", "temporal_dn2", "fixed_dn2", "pixels")
_LEVEL_HEAD = ("file", "frames", "mean (DN)", "temporal σ² (DN²)", "fixed σ² (DN²)", "")


_TRANSFER = (
    ("gain_e_per_dn", "e-/DN", "electrons per digital number"),
    ("gain_error", "e-/DN", "standard error of the gain"),
    ("offset_dn", "DN", "dark level"),
    ("read_noise_e", "e-", "temporal noise in the dark, without quantization noise"),
    ("read_noise_error", "e-", "standard error of the read noise"),
    ("full_well_e", "e-", "saturation level"),
    ("brightest_e", "e-", "the brightest level"),
    ("dynamic_range_dB", "dB", "full well divided by read noise"),
    ("dsnu_e", "e-", "fixed-pattern noise in the dark"),
    ("prnu_percent", "%", "fixed-pattern noise proportional to the signal"),
    # Where EMVA 1288 defines a figure otherwise, or has one more.
    ("system_gain_dn_per_e", "DN/e-", "K of EMVA 1288: 1/gain"),
    (
        "saturation_capacity_e",
        "e-",
        "µe.sat of EMVA 1288: level with the largest temporal variance",
    ),
    ("sensitivity_threshold_e", "e-", "µe.min of EMVA 1288: signal at SNR 1"),
    ("emva_dynamic_range_dB", "dB", "µe.sat divided by µe.min"),
    ("snr_max_dB", "dB", "√µe.sat"),
    ("dsnu_row_e", "e-", "row component of DSNU"),
    ("dsnu_column_e", "e-", "column component of DSNU"),
    ("dsnu_pixel_e", "e-", "pixel component of DSNU"),
    ("prnu_row_percent", "%", "row component of PRNU"),
    ("prnu_column_percent", "%", "column component of PRNU"),
    ("prnu_pixel_percent", "%", "pixel component of PRNU"),
)


def _rows(figures: Sequence[tuple[str, str, str]], **values: Any) -> list[Row]:
    return [(name, values[name], unit, meaning) for name, unit, meaning in figures]


def _decibels(ratio: float | None) -> float | None:
    return 20.0 * math.log10(ratio) if ratio else None


def _structured(path: Path, field: FlatField, what: str) -> list[str]:
    """The warning of a field whose pixels differ by its structure, and `what` that touches."""
    share = field.structure_share
    if share <= _MOSTLY:
        return []
    return [
        f"warning: {path.name}: {100.0 * share:.0f} % of the variance between pixels comes from "
        f"structure wider than 8 pixels, as in {what} include this structure. Give frames of a "
        "uniform field"
    ]


def _transfer_remarks(curve: PhotonTransfer, dark: Path | None) -> list[str]:
    lines = []
    if curve.dark_cut_off:
        lines.append(
            f"{dark}: the converter clips the noise at 0, so these dark "
            "frames are not used. Raise the camera's offset, or give --offset-dn"
        )
    elif curve.offset_dn is None:
        lines.append("read noise and full well need --dark FILE, or --offset-dn DN")
    if curve.offset_dn is not None and curve.full_well_e is None:
        lines.append(
            "no level is saturated, so the full well is above the brightest level. "
            "Add a brighter level"
        )
    return lines


def measured_transfer(
    flats: Sequence[Path],
    dark: Path | None,
    offset_dn: float | None,
    *,
    check: Callable[[], None],
    report: Callable[[str], object],
) -> UniformFields:
    """The curve of one camera's flat fields; the dark level from dark frames, or as it is given."""

    def field(file: FrameFile) -> FlatField:
        report(file.path.name)
        taken = FlatFrames(file.rows, file.columns)
        for frame in _frames(file, check):
            taken.add(frame)
        return taken.measured()

    files = [open_frames(path) for path in (*flats, *filter(None, [dark]))]
    check_one_camera(files, of_one="a flat field")
    fields = [field(file) for file in files]
    levels = fields[: len(flats)]
    dark_field = None if dark is None else fields[-1]
    curve = photon_transfer(levels=levels, dark=dark_field, offset_dn=offset_dn)
    return _of_transfer(flats, levels, dark, curve)


def _of_transfer(
    files: Sequence[Path], fields: Sequence[FlatField], dark: Path | None, curve: PhotonTransfer
) -> UniformFields:
    well = curve.full_well_e / curve.read_noise_e if curve.full_well_e and curve.read_noise_e else 0
    decibels = {
        "dynamic_range_dB": _decibels(well),
        "emva_dynamic_range_dB": _decibels(curve.dynamic_range),
        "snr_max_dB": _decibels(curve.snr_max),
    }
    figures, remarks = _rows(_TRANSFER, **vars(curve), **decibels), _transfer_remarks(curve, dark)
    levels: list[tuple[str, ...]] = [_LEVEL_HEAD]
    facts, table = [], list[Row]()
    states = zip(files, fields, curve.used, curve.saturated, strict=True)
    for path, field, used, saturated in states:
        values = map(number_text, (field.mean_dn, field.temporal_dn2, field.fixed_dn2))
        state = "saturated" if saturated else "" if used else "not used for the fit"
        levels.append((path.name, str(field.frames), *values, state))
        fact = {"file": str(path), **values_of(field, *_OF_LEVEL)}
        fact |= {"bad_pixels": field.bad, "structure_share": field.structure_share}
        facts.append(fact | {"used": used, "saturated": saturated})
        table.append((f"{path.name}: mean_dn", field.mean_dn, "DN", "mean of this level"))
        meaning = "temporal variance of this level"
        table.append((f"{path.name}: temporal_dn2", field.temporal_dn2, "DN²", meaning))
        if not saturated:  # of these it says nothing
            remarks += _structured(path, field, "a scene or uneven light. PRNU and DSNU")
    content = {
        "format": "imagechain-photon-transfer",
        "version": 1,
        "figures": {name: value for name, value, _, _ in figures},
        "dark_cut_off": curve.dark_cut_off,
        "levels": facts,
    }
    return UniformFields(figures, 6, levels, range(1, 5), remarks, content, table)


# SiTF, NETD and 3-D noise of an infrared camera from frames of black bodies.

_COARSE = 0.5  # of the converter's step, below which rounding makes or hides the noise
_DEPARTS = 0.5  # per cent of the span
_CHANCE = 8  # samples at an end of a small frame
_PILED_UP = 0.01  # of the samples at an end: of a normal distribution next to none are
_FEW = 16  # frames, of which the components in time are hardly known
Frames = NDArray[np.floating]


def measured_netd(
    given: Sequence[tuple[Path, float]],
    *,
    check: Callable[[], None],
    report: Callable[[str], object],
) -> UniformFields:
    """The response of one camera to a black body at each of these temperatures, in kelvin."""
    paths, kelvins = zip(*given, strict=True)
    files = [open_frames(path) for path in paths]
    check_one_camera(files, of_one="temporal noise")
    fields = _fields(files, kelvins, report, check)
    # By temperature, as the response has them.
    ordered = sorted(zip(paths, fields, strict=True), key=lambda one: one[1].temperature_K)
    return _of_netd(ordered, thermal.thermal_response(fields), files[0].unit or "DN")


def _of_netd(
    files: Sequence[tuple[Path, thermal.ThermalField]], response: thermal.ThermalResponse, unit: str
) -> UniformFields:
    of_middle = [(name, of.format(unit=unit), meaning) for name, of, meaning in _NETD]
    figures, table = _rows(of_middle, **vars(response.middle)), list[Row]()
    if response.wavelength_um is not None:
        figures += _rows(_WAVELENGTH, **vars(response))
    levels: list[tuple[str, ...]] = [_NETD_HEAD]
    facts = []
    for (path, field), at in zip(files, response.levels, strict=True):
        own, flat = values_of(at, *(name for name, _, _ in _NETD)), field.field
        own |= {f"sigma_{name}_K": value for name, value in at.components_K.items()}
        parts = [at.components_K[name] for name in COMPONENTS if name != "tvh"]
        levels.append(
            (
                path.name, f"{at.temperature_K:.2f}", str(field.noise.frames),
                number_text(float(f"{flat.mean_dn:.6g}")),
                number_text(float(f"{at.sitf:.5g}")), _millikelvin(at.netd_K),
                # An unbiased estimate of next to nothing comes out below zero half the time.
                *(_millikelvin(max(part, 0.0)) for part in parts),
            )
        )  # fmt: skip
        fact = {"file": str(path), **own, "frames": field.noise.frames, "mean": flat.mean_dn}
        facts.append(fact | {"bad_pixels": flat.bad, "structure_share": flat.structure_share})
        for name, value in own.items():
            of = f"{unit}/K" if name.startswith("sitf") else "K"
            table.append((f"{path.name}: {name}", value, of, "at this temperature"))
    content = {
        "format": "imagechain-netd",
        "version": 1,
        "unit": unit,
        "figures": {name: value for name, value, _, _ in figures},
        "departure_percent": response.departure_percent,
        "levels": facts,
    }
    remarks = _netd_remarks(files, response)
    return UniformFields(figures, 5, levels, range(1, 13), remarks, content, table)


def _fields(
    files: Sequence[FrameFile],
    temperatures: Sequence[float],
    report: Callable[[str], object],
    check: Callable[[], None],
) -> list[thermal.ThermalField]:
    """Mean and noise of each; a pixel that is bad in one is left out of all."""
    flats = []
    good = np.ones((files[0].rows, files[0].columns), bool)
    for file in files:
        report(file.path.name)
        taken = FlatFrames(file.rows, file.columns)
        first: Frames | None = None
        for frame in _frames(file, check):
            first = frame if first is None else first
            taken.add(frame)
        flats.append(taken.measured())
        own = taken.good_pixels()
        if first is not None:
            _refuse_useless(file, np.asarray(first[own], np.float64), flats[-1])
        good &= own
    fields = []
    for file, kelvin, flat in zip(files, temperatures, flats, strict=True):
        report(file.path.name)
        cube = NoiseCube(file.rows, file.columns)
        for frame in _frames(file, check):
            cube.add(thermal.filled(frame, good))
        fields.append(thermal.ThermalField(kelvin, flat, cube.measured()))
    return fields


def _frames(file: FrameFile, check: Callable[[], None]) -> Iterator[Frames]:
    for frame in file.each():
        check()
        yield frame


def _refuse_useless(file: FrameFile, good: NDArray[np.float64], field: FlatField) -> None:
    """Levels without noise, or of which mean and noise are cut off."""
    if not math.isfinite(field.temporal_dn2):
        raise DataError(f"{file.path}: the samples are too large for their variance to be computed")
    if not field.temporal_dn2 > 0.0:
        raise DataError(
            f"{file.path}: all frames are the same. The field is saturated, rounding hides the "
            "noise, or the file repeats one frame"
        )
    if not float(np.median(np.abs(good - np.median(good)))) > 0.0:
        return  # of few whole numbers the last is often a frequent one
    for end, what in ((good.min(), "clipped at the lower end"), (good.max(), "saturated")):
        many = int(np.count_nonzero(good == end))
        if many > max(_PILED_UP * good.size, _CHANCE):
            raise DataError(
                f"{file.path}: {100.0 * many / good.size:.2g} % of the samples are {end:.6g}. "
                f"The field is {what}, so its mean and noise cannot be used. Change the "
                "temperature, the exposure or the offset"
            )


_NETD = (
    ("temperature_K", "K", "middle of the temperature range, at which SiTF and NETD apply"),
    ("sitf", "{unit}/K", "change of the mean signal with temperature"),
    ("sitf_error", "{unit}/K", "standard error of SiTF, if the temperatures are exact"),
    ("netd_K", "K", "σ_tvh (noise random in time, row and column) divided by SiTF"),
    ("netd_error_K", "K", "standard error of NETD"),
    ("temporal_K", "K", "all temporal noise, divided by SiTF"),
)
_WAVELENGTH = (
    ("wavelength_um", "µm", "effective wavelength, from fitting Planck's law to the means"),
    ("wavelength_error_um", "µm", "standard error of the wavelength"),
)


_NETD_HEAD = (
    "file", "K", "frames", "mean", "SiTF", "NETD mK",
    *(f"{name} mK" for name in COMPONENTS if name != "tvh"),
)  # fmt: skip


def _millikelvin(kelvin: float) -> str:
    return number_text(float(f"{1e3 * kelvin:.4g}"))


def _netd_remarks(
    files: Sequence[tuple[Path, thermal.ThermalField]], response: thermal.ThermalResponse
) -> list[str]:
    lines = []
    if len(response.levels) == 2:
        lines.append(
            "with two temperatures, SiTF is known only midway between them, and this value is "
            "used for both temperatures. Give frames at three or more temperatures to see how SiTF "
            "changes"
        )
    departure = response.departure_percent
    if departure is not None and departure > _DEPARTS:
        lines.append(
            "warning: the largest residual of the Planck fit is "
            f"{departure:.2g} % of the range of the mean signals. The temperatures are wrong, the "
            "camera drifted, or its response is nonlinear. Check the temperatures, let the camera "
            "settle, or use a smaller range of temperatures"
        )
    few = min(field.noise.frames for _, field in files)
    if few < _FEW:
        lines.append(
            f"with only {few} frames, the temporal noise of whole frames, rows and columns is "
            f"uncertain, and fixed-pattern noise is known only down to NETD/√{few}. Take 64 frames "
            "or more"
        )
    bad = max(field.field.bad for _, field in files)
    if bad:
        lines.append("1 bad pixel is left out" if bad == 1 else f"{bad} bad pixels are left out")
    for path, field in files:
        random = field.noise.variances.tvh
        step = field.field.step_dn
        if random < (_COARSE * step) ** 2:
            lines.append(
                f"warning: {path.name}: the noise is {math.sqrt(max(random, 0.0)) / step:.2g} "
                "times the converter's step. Rounding adds to the noise or hides it, so NETD is "
                "wrong. Raise the gain before the converter"
            )
        fixed = "a non-uniform field. The fixed components vh, v and h"
        lines += _structured(path, field.field, fixed)
    return lines
