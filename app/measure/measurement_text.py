"""A measurement in words, in rows of figures and as files."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from app.run.terminal import number_text
from core.errors import several

if TYPE_CHECKING:
    from app.measure import picture_measurement as results
    from core.physics.measurement.edge_mtf import MtfCurve
    from core.physics.measurement.sample_noise import SampleNoise

# Of what changes from frame to frame: what stays is the scene's as well.
TEMPORAL = ("tvh", "t", "tv", "th")
_GAMMA = {
    "usual": "8-bit values in this format are usually gamma-encoded",
    "possible": "8-bit values may be gamma-encoded",
}
NYQUIST = 0.5  # cycles per sample
_MOST_REASONS = 8
_ABOVE_ONE, _LEAST_ABOVE = 3.0, 0.02  # standard errors, and of an MTF
_FEW = 2  # edges, that others do not confirm
_SCATTERED = 1.5  # times their own errors
_PLACES = 7  # after the point, or before it: beyond, powers of ten
Row = tuple[str, str, str, str]


def with_error(value: float | None, error: float | None) -> str:
    """A figure to the digits that its standard error, of two digits, leaves."""
    if value is None:
        return "–"
    if error is None or not (error > 0.0 and math.isfinite(error)):
        return number_text(float(f"{value:.4g}"))
    last = 1 - math.floor(math.log10(float(f"{error:.2g}")))
    if not -_PLACES < last < _PLACES:
        return f"{value:.3g} ± {error:.2g}"
    value, error = round(value, last) + 0.0, round(error, last)  # no -0
    return f"{value:.{max(last, 0)}f} ± {error:.{max(last, 0)}f}"


def figure_rows(measured: results.PictureMeasurement) -> list[Row]:
    used = sum(edge.used for edge in measured.edges)
    rows: list[Row] = [
        ("edges", str(used), "", f"edges used, of {len(measured.edges)} found"),
        *_mtf_rows("x", "horizontal", measured.x, measured.interval_x_mrad, measured.pitch_um),
        *_mtf_rows("y", "vertical", measured.y, measured.interval_y_mrad, measured.pitch_um),
    ]
    if measured.noise is not None:
        rows += _noise_rows(measured.noise, measured.unit)
    return rows


def _mtf_rows(
    name: str, words: str, curve: MtfCurve | None, interval: float | None, pitch_um: float | None
) -> list[Row]:
    if curve is None:
        return []
    many = several(curve.edges, "edge")
    rows: list[Row] = []
    if curve.mtf50 is not None:
        of = f"frequency at which the {words} MTF is one half"
        for unit, per_sample, meaning in (
            ("cyc/sample", 1.0, f"{of}, from {many}"),
            ("cyc/mrad", interval, f"{of}, in object space, from {many}"),
            ("cyc/mm", pitch_um and 1e-3 * pitch_um, f"{of}, on the detector, from {many}"),
        ):
            if per_sample is not None:
                error = None if curve.mtf50_sigma is None else curve.mtf50_sigma / per_sample
                text = with_error(curve.mtf50 / per_sample, error)
                rows.append((f"mtf50_{name}", text, unit, meaning))
    if curve.frequency[-1] >= NYQUIST:
        value, error = (
            float(np.interp(NYQUIST, curve.frequency, of)) for of in (curve.mtf, curve.sigma)
        )
        meaning = f"{words} MTF at the Nyquist frequency, pixel aperture included, from {many}"
        rows.append((f"mtf_nyquist_{name}", with_error(value, error), "", meaning))
    return rows


def _noise_rows(noise: SampleNoise, unit: str) -> list[Row]:
    rows = [("sigma", with_error(noise.sigma, noise.sigma_error), unit, "noise of a sample")]
    for name, words, value in (
        ("row_sigma", "row", noise.row_sigma), ("column_sigma", "column", noise.column_sigma),
    ):  # fmt: skip
        if value:
            text = number_text(float(f"{value:.3g}"))
            rows.append((name, text, unit, f"{words} noise"))
    if noise.gain_e_per_dn is not None:
        gain = with_error(noise.gain_e_per_dn, noise.gain_error)
        rows.append(("gain", gain, "e-/DN", "electrons per digital number"))
    if noise.read_noise_dn is not None:
        read = with_error(noise.read_noise_dn, noise.read_noise_error)
        meaning = f"noise at the dark level of {noise.offset_dn:.6g}"
        rows.append(("read_noise", read, unit or "DN", meaning))
    return rows


def frame_rows(measured: results.PictureMeasurement) -> list[Row]:
    if measured.frames is None:
        return []
    from core.physics.noise.noise_components import MEANINGS

    rows = []
    for name in TEMPORAL:
        # An unbiased estimate of next to nothing comes out below zero half the time.
        sigma = max(measured.frames.variances.sigma(name), 0.0)
        text = number_text(float(f"{sigma:.4g}"))
        rows.append((f"sigma_{name}", text, measured.unit, MEANINGS[name]))
    return rows


def file_warnings(files: Sequence[results.PictureFile]) -> list[str]:
    """What of the files' formats makes their numbers other than the camera's."""
    from app.measure.picture_measurement import WITH_LOSS

    lines = [
        f"{file.name}: {_GAMMA[file.gamma]}, but are treated as linear. If the camera applied a "
        "gamma curve, the figures are wrong. Use raw or linear samples"
        for file in files
        if file.gamma and not file.is_lossy
    ]
    lines += [
        f"{file.name}: {WITH_LOSS}. Give a picture that the camera stored without lossy compression"
        for file in files
        if file.is_lossy
    ]
    return lines


def exceeds_one(curve: MtfCurve, least: float) -> bool:
    """Whether an MTF is above one by so much at least, and by more than its error."""
    return bool(np.any(curve.mtf > 1.0 + np.maximum(_ABOVE_ONE * curve.sigma, least)))


def remarks(measured: results.PictureMeasurement) -> list[str]:
    """What was measured of files with bands, and what could not be measured, and why."""
    from core.physics.measurement.edge_mtf import LARGEST_ANGLE_DEG

    lines = [f"measured from {file.name}: {file.taken}" for file in measured.files if file.taken]
    lines += [f"warning: {line}" for line in file_warnings(measured.files)]
    lines += [f"warning: {line}" for line in measured.warnings]
    for words, curve, reason in (
        ("horizontal", measured.x, measured.reason_x),
        ("vertical", measured.y, measured.reason_y),
    ):
        if curve is None:
            lines.append(f"no {words} MTF: {reason}")
            continue
        if curve.mtf50 is None:
            lines.append(f"no {words} MTF50: the MTF does not fall to one half")
        if exceeds_one(curve, _LEAST_ABOVE):
            lines.append(
                f"warning: the {words} MTF exceeds 1. The picture was sharpened, so this MTF "
                "includes the sharpening"
            )
        if curve.edges <= _FEW:
            many = "one edge" if curve.edges == 1 else f"{curve.edges} edges"
            others = sum(edge.used for edge in measured.edges) - curve.edges
            lines.append(
                f"warning: only {many} with a normal within {LARGEST_ANGLE_DEG:g}° of the {words} "
                f"can be used. The {words} MTF also depends on edges in other directions, and its "
                "error is estimated from few edges"
                if others > 0
                else f"warning: the {words} MTF comes from only {many}, so its error could not be "
                "checked"
            )
        if curve.scatter > _SCATTERED:
            lines.append(
                f"warning: the {words} MTFs of the edges scatter by {curve.scatter:.2g} times "
                "their own errors. The blur varies over the picture, or some edges are not "
                "sharp in the scene. The standard error of the MTF is enlarged accordingly"
            )
    if measured.noise is None:
        lines.append(f"no noise: {measured.noise_reason}")
    else:
        lines += measured.noise.remarks
        if measured.noise.reason:
            lines.append(measured.noise.reason)
        known = (measured.noise.gain_e_per_dn, measured.noise.read_noise_dn)
        if None in known:
            lines.append(
                "to get gain and read noise, give `imagechain photon-transfer` frames of flat "
                "fields at several levels, and dark frames"
            )
    if measured.picture_count > 1 and measured.frames is None:
        lines.append(f"temporal noise not measured: {measured.frames_reason}")
    return lines


def refused_lines(measured: results.PictureMeasurement) -> list[str]:
    kinds = counted(edge.why_not for edge in measured.edges if not edge.used)
    lines = [f"{several(count, 'edge')} not used: {kind}" for kind, count in kinds[:_MOST_REASONS]]
    if lines and not any(edge.used for edge in measured.edges):
        lines.append("for advice, run imagechain handbook edge_pictures")
    return lines


# How edges look on a picture, everywhere.

USED, REFUSED, REMOVED = "#e69f00", "#56b4e9", "#f0e442"
"""Of edges in use, not in use, and removed by hand: Okabe and Ito's orange, sky blue and yellow,
which all kinds of sight tell apart, on grey too. The lines differ as well: full, dashed, dotted."""


# Why edges are not used: the reason, and its figures behind a colon.

_MOST = 3


def counted(reasons: Iterable[str]) -> list[tuple[str, int]]:
    """Reasons without their figures, the most frequent first, and how often each comes."""
    return Counter(why_not.partition(":")[0] for why_not in reasons).most_common()


def in_words(reasons: Iterable[str]) -> str:
    """The most frequent reasons, each with how many edges it stands for, in one line."""
    kinds = counted(reasons)
    words = ", ".join(f"{kind} ({count})" for kind, count in kinds[:_MOST])
    left = sum(count for _, count in kinds[_MOST:])
    return f"{words}, other reasons ({left})" if left else words
