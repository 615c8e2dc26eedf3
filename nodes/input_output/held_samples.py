"""Samples of a scene that are in memory, not in a file, and the picture that is read from them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import DataError
from core.evaluation.recipes import Step, in_blocks
from core.evaluation.work import Work
from core.lineage.step_lineage import source_step
from nodes.files.common.picture_info import PictureInfo
from nodes.files.read import check_finite
from nodes.input_output.source_file import scaled_samples

Samples = NDArray[np.floating[Any]]
_SHAPES = "allowed is (rows, columns), or (bands, rows, columns) with their wavelengths"


@dataclass(frozen=True, eq=False)
class HeldSamples:
    """Samples that nobody can change any more, named by their content.

    Parameters
    ----------
    samples : ndarray
        (rows, columns), or (bands, rows, columns); float32 or float64, C order, read-only.
    name : str
        What they are called in messages.
    wavelengths_um : tuple of float or None
        Middle of every band; None of a picture without bands.
    widths_um : tuple of float or None
        Width of every band; None where it reaches half-way to its neighbours.
    """

    samples: Samples
    name: str = field(default="the array")
    wavelengths_um: tuple[float, ...] | None = None
    widths_um: tuple[float, ...] | None = None

    @classmethod
    def of(
        cls,
        array: NDArray[Any],
        name: str = "the array",
        wavelengths_um: tuple[float, ...] | None = None,
        widths_um: tuple[float, ...] | None = None,
    ) -> HeldSamples:
        """A copy: float32 as it is, all other real numbers as float64.

        Raises
        ------
        DataError
            The array is no picture, or cube, of finite real numbers.
        """
        if array.dtype.kind not in "buif":
            raise DataError(f"{name} has samples of type {array.dtype}: allowed are real numbers")
        if array.ndim != (2 if wavelengths_um is None else 3) or array.size == 0:
            raise DataError(f"{name} has the shape {array.shape}: {_SHAPES}")
        for what, values in (("wavelengths_um", wavelengths_um), ("widths_um", widths_um)):
            if values is not None and len(values) != len(array):
                raise DataError(f"{what} has {len(values)} numbers for {len(array)} bands")
        if np.ma.is_masked(array):
            raise DataError(f"{name} has masked samples: put a number in their place")
        single = array.dtype.newbyteorder("=") == np.float32
        kept: Any = np.float32 if single else np.float64
        samples: Samples = np.array(array, kept, order="C", copy=True)
        for place, band in enumerate(samples.reshape(-1, *samples.shape[-2:])):
            check_finite(band, name if samples.ndim == 2 else f"{name}, band {place}")
        samples.flags.writeable = False
        return cls(samples.view(), name, wavelengths_um, widths_um)

    def __reduce__(self) -> tuple[Any, ...]:
        # Made anew, so that it is read-only again.
        fields = (self.samples, self.name, self.wavelengths_um, self.widths_um)
        return HeldSamples.of, fields

    @cached_property
    def key(self) -> str:
        """Content key: equal samples of equal type have the same."""
        digest = hashlib.blake2b(self.samples.data, digest_size=16)
        samples = self.samples
        about = (samples.shape, samples.dtype.str, self.wavelengths_um, self.widths_um)
        digest.update(repr(about).encode())
        return digest.hexdigest()

    @property
    def info(self) -> PictureInfo:
        """What a file of them would say."""
        rows, columns = self.samples.shape[-2:]
        return PictureInfo(
            path=Path(self.name),
            rows=rows,
            columns=columns,
            bands=1 if self.wavelengths_um is None else len(self.wavelengths_um),
            unit=None,
            wavelengths_um=self.wavelengths_um,
            fwhm_um=self.widths_um,
            focal_length_mm=None,
            fov_x_deg=None,
            fov_y_deg=None,
            dtype=self.samples.dtype.name,
            kind="array",
        )

    def step(self, *, scale: float, offset: float, node: str) -> Step:
        """Recipe of the samples times `scale` plus `offset`."""
        return Step.of(scaled_array, node=node, held=self, scale=scale, offset=offset)


@in_blocks()
@source_step(area_means=False)  # as a scene in a file, it may be blurred by anything
def scaled_array(work: Work, *, held: HeldSamples, scale: float, offset: float) -> Samples:
    """Samples in the evaluation's precision; errors as `scaled_samples`."""
    if scale == 1.0 and offset == 0.0 and held.samples.dtype == work.policy.dtype:
        return held.samples
    return scaled_samples(work, held.samples, scale, held.name, offset)
