"""Noise in the flat areas of pictures of one camera, taken together."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from app.measure.picture_measurement import NoiseFigures
from core.physics.measurement.noise.frames_noise import FramesNoise
from core.physics.measurement.noise.picture_noise import PictureNoise
from core.physics.measurement.noise.power_parts import LineNoise

_SEVERAL = 2
_STANDS_OUT = 3.0  # standard errors
_Figure = tuple[float | None, float | None]


def pooled_noise(
    measured: Sequence[PictureNoise], *, offset_dn: float
) -> tuple[NoiseFigures | None, str]:
    """The noise of the pictures that show it, or the reason why none does.

    Parameters
    ----------
    measured : sequence of PictureNoise
        One of each picture.
    offset_dn : float
        The level without light that they were measured with.

    Notes
    -----
    Variances are averaged; gain and read noise are means weighted by their errors.
    """
    known = [(one, one.sigma, one.sigma_error) for one in measured]
    good = [(one, s, e) for one, s, e in known if s is not None and e is not None]
    if not good:
        return None, "; ".join(_once(one.sigma_reason for one in measured))
    noises = [one for one, _, _ in good]
    sigma = math.sqrt(math.fsum(s**2 for _, s, _ in good) / len(good))
    error = math.sqrt(math.fsum((s * e) ** 2 for _, s, e in good)) / (sigma * len(good))
    gain, gain_error = _weighted((one.gain_e_per_dn, one.gain_error) for one in noises)
    read, read_error = _weighted((one.read_noise_dn, one.read_noise_error) for one in noises)
    no_gain = _once(one.gain_reason for one in noises) if gain is None else []
    no_read = _once(one.read_noise_reason for one in noises) if read is None else []
    powers = [one.power for one in noises if one.power is not None]
    steps = [one.step for one in noises if one.step is not None]
    return NoiseFigures(
        sigma, error, math.fsum(one.mean_level for one in noises) / len(noises), gain, gain_error,
        read, read_error, offset_dn, _lines(power.rows for power in powers),
        _lines(power.columns for power in powers), min(steps) if steps else None,
        next((power.lines for power in powers if power.lines), ()),
        tuple(level for one in noises for level in one.levels),
        _missing(_first(no_gain), _first(no_read)),
        tuple(_once(line for one in noises for line in one.remarks)),
    ), ""  # fmt: skip


def with_frames(
    noise: NoiseFigures | None, reason: str, frames: FramesNoise, offset_dn: float
) -> tuple[NoiseFigures | None, str]:
    """The noise of what changes in frames of a scene that stands still.

    In one frame, fine texture and a fixed pattern look like noise; of them nothing is left here.
    Periodic lines are those of the single pictures.
    """
    if frames.sigma is None or frames.sigma_error is None:
        return noise, reason
    missing = _missing(
        frames.gain_reason if frames.gain_e_per_dn is None else "",
        frames.read_noise_reason if frames.read_noise_dn is None else "",
    )
    return NoiseFigures(
        frames.sigma, frames.sigma_error, frames.mean_level, frames.gain_e_per_dn,
        frames.gain_error, frames.read_noise_dn, frames.read_noise_error, offset_dn, None, None,
        frames.step, () if noise is None else noise.lines, frames.levels, missing,
        ("noise is that of what changes from frame to frame, without fixed patterns",),
    ), ""  # fmt: skip


def _missing(no_gain: str, no_read: str) -> str:
    """Why there is no gain, and no read noise; each empty where there is."""
    if no_gain and no_gain == no_read:
        return f"no gain and no read noise: {no_gain}"
    parts = (("no gain", no_gain), ("no read noise", no_read))
    return "; ".join(f"{what}: {why}" for what, why in parts if why)


def _first(reasons: Sequence[str]) -> str:
    """The first reason, and that other pictures have others of their own."""
    if len(reasons) < _SEVERAL:
        return "".join(reasons)
    return f"{reasons[0]} (and the like of other pictures)"


def _once(texts: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(text for text in texts if text))


def _weighted(figures: Iterable[_Figure]) -> _Figure:
    """Mean by inverse variances; nothing where no picture has the figure."""
    known = [(value, error) for value, error in figures if value is not None and error]
    if not known:
        return None, None
    weights = [1.0 / error**2 for _, error in known]
    total = math.fsum(weights)
    mean = math.fsum(w * value for w, (value, _) in zip(weights, known, strict=True)) / total
    return mean, total**-0.5


def _lines(lines: Iterable[LineNoise | None]) -> float | None:
    """Deviation of what rows or columns have of their own, 0 where it does not stand out."""
    known = [line for line in lines if line is not None]
    if not known:
        return None
    variance = math.fsum(line.variance for line in known) / len(known)
    error = math.sqrt(math.fsum(line.variance_error**2 for line in known)) / len(known)
    return math.sqrt(variance) if variance > _STANDS_OUT * error else 0.0
