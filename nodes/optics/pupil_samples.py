"""Steps that read the amplitude and the wavefront of a pupil from files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.physics.optics.measured.wavefront_map import known_wavefront, wrapped_waves
from nodes.files.read import check_finite
from nodes.optics.lens_source import stored_samples

Array = NDArray[Any]


@ends_lineage
def loaded_opening(work: Work, *, file: Path, **reading: Any) -> Array:
    """Amplitude transmission over its largest; of complex samples their modulus."""
    samples = stored_samples(file=file, **reading)
    check_finite(samples, file.name)
    if np.isrealobj(samples) and samples.min() < 0:
        raise DataError(_refusal(file))
    samples = np.abs(samples)
    if not samples.any():
        raise DataError(_refusal(file))
    return np.asarray(samples / samples.max())


@ends_lineage
def loaded_phase(work: Work, *, file: Path, **reading: Any) -> Array:
    """Wavefront of complex samples, waves."""
    return wrapped_waves(stored_samples(file=file, **reading))


@ends_lineage
def loaded_map(work: Work, *, factor: float, file: Path, **reading: Any) -> Array:
    """Wavefront map times `factor`, NaN where it is not known."""
    try:
        return factor * known_wavefront(stored_samples(file=file, **reading))
    except DataError as error:
        raise DataError(f"{file.name}: {error.message}") from error


@ends_lineage
def known_opening(
    work: Work, wavefront: Array, opening: Array | None = None, *, name: str
) -> Array:
    """Transmission where a wavefront map is known, 1 if not given, and 0 elsewhere."""
    known = np.isfinite(wavefront)
    samples = known.astype(np.float64) if opening is None else np.where(known, opening, 0.0)
    if not samples.any():
        raise DataError(f"{name}: the wavefront map is known nowhere that the pupil transmits")
    return np.asarray(samples / samples.max())


@ends_lineage
def known_waves(work: Work, wavefront: Array) -> Array:
    """A wavefront map with 0 where it is not known."""
    return np.nan_to_num(wavefront, nan=0.0)


def _refusal(file: Path) -> str:
    return f"{file.name}: a pupil needs transmissions of 0 and above, and not 0 alone"
