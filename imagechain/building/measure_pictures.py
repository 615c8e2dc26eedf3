"""Measure pictures of a camera, from files or arrays, and fit a chain to them."""

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.fit.chain_transfer import free_parameters
from app.fit.fit_page import fit_content, fit_facts, fit_text
from app.fit.fit_result import FitResult
from app.fit.picture_fit import fit_pictures, opened_pictures
from app.measure import measuring
from app.measure.measurement_page import measurement_facts, write_measurement
from app.measure.measurement_text import figure_rows, refused_lines, remarks
from app.measure.picture_measurement import (
    NO_DATA,
    PictureFile,
    PictureMeasurement,
    limits_of,
    same_size,
)
from app.run.terminal import columns, jsonable
from core.atomic import write_text
from core.errors import DataError, ParameterError, UsageError
from core.evaluation.work import Policy, Precision
from imagechain.building.chain import Chain
from imagechain.building.chain import open as open_chain
from imagechain.parts.plain_errors import plain_errors


class MeasuredPictures:
    """MTF, edges and noise of pictures.

    `x` and `y` are the pooled horizontal and vertical MTFs, with `frequency` (cycles/sample),
    `mtf`, `sigma` (the standard error of `mtf`), `mtf50` and `mtf50_sigma`. If an MTF could not be
    measured, `x` or `y` is None, and the reason is in `reason_x` or `reason_y`. `edges` lists all
    edges that were found, each with `used`, `why_not`, `found` (place, angle, levels) and its own
    `curve`. `noise`, measured in flat areas, has `sigma`, `sigma_error`, `gain_e_per_dn` and
    `read_noise_dn`; `noise` is None if the noise could not be measured.
    """

    def __init__(self, measured: PictureMeasurement) -> None:
        self._measured = measured
        self.x, self.y = measured.x, measured.y
        self.reason_x, self.reason_y = measured.reason_x, measured.reason_y
        self.edges, self.noise = measured.edges, measured.noise

    @plain_errors
    def without(self, edge: int) -> "MeasuredPictures":
        """Return a copy of the result without one edge, given by its index in `edges`."""
        many = len(self.edges)
        if not 0 <= edge < many:
            raise ParameterError(
                "edge", edge, f"0 to {many - 1}" if many else "the pictures have no edges"
            )
        return MeasuredPictures(measuring.without_edge(self._measured, edge))

    def to_dict(self) -> dict[str, Any]:
        """The complete result as a dictionary, like the JSON of `imagechain measure --json`."""
        content: dict[str, Any] = jsonable(measurement_facts(self._measured))
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
        Files of pictures or frames; or arrays, (rows, columns) or (frames, rows, columns). All
        pictures must have the same size.
    band : int, optional
        Band or colour to measure, counted from 0, in files with several bands.
    fov_x_deg : float, optional
        Horizontal field of view, degrees, instead of the value in the files.
    pitch_um : float, optional
        Pixel pitch, µm, for frequencies in cycles/mm.
    offset_dn : float, optional
        Dark level, DN, for the read noise; by default 0.
    dark : path, optional
        File of dark frames, instead of `offset_dn`.
    """
    if not pictures:
        raise UsageError("measure needs a picture: give a file or an array")
    if all(isinstance(one, str | PathLike) for one in pictures):
        paths = tuple(Path(fspath(one)) for one in pictures)  # type: ignore[arg-type]
        own = None if dark is None else Path(fspath(dark))
        words = band, fov_x_deg, own, offset_dn, pitch_um
        return MeasuredPictures(measuring.measure_files(paths, *words))
    if dark is not None or band is not None:
        raise UsageError("band and dark apply to files only, not to arrays")
    files = of_arrays(pictures)
    same_size(files)
    return MeasuredPictures(measuring.measure_pictures(files, fov_x_deg, offset_dn, pitch_um))


# Pictures of a camera that are given as arrays.

_FRAMES = 3  # dimensions


def of_arrays(pictures: Sequence[Any]) -> list[PictureFile]:
    """Arrays, (rows, columns) or (frames, rows, columns); ends of numbers where all have them."""
    ends = {limits_of(np.asarray(picture).dtype) for picture in pictures}
    limits = ends.pop() if len(ends) == 1 else None
    files = []
    for number, array in enumerate(map(np.asarray, pictures), 1):
        if array.dtype.kind not in "buif" or array.ndim not in (2, _FRAMES) or 0 in array.shape:
            raise DataError(
                f"picture {number} is an array of {array.dtype} with shape {array.shape}; allowed: "
                "real numbers, (rows, columns) or (frames, rows, columns)"
            )
        if not np.isfinite(array).all():
            raise DataError(f"picture {number} has samples that are not finite; {NO_DATA}")
        own = [*array] if array.ndim == _FRAMES else [array]
        files.append(PictureFile.of(f"array {number}", own, limits=limits))
    return files


# The result of `imagechain.fit`: values with their errors, and the chain with these values.


class FittedChain:
    """Parameters of a chain, fitted to pictures.

    `parameters` gives the `value` and the standard error `sigma` of each parameter; both are None
    if the pictures do not determine the parameter. `combinations` gives the value and standard
    error of each combination of parameters that cannot be separated. `warnings` lists what to check
    before you trust the values; `notes` lists what was fitted and assumed. `correlation` is the
    correlation matrix of the errors, in the order of `parameters`, with NaN for undetermined
    entries. `chi2_per_degree` is the reduced χ², which is 1 if the residuals are only noise.
    `chain` is the chain with the fitted values, to run and to save.
    """

    def __init__(self, result: FitResult, chain: Chain, pictures: tuple[str, ...]) -> None:
        self._result, self._pictures = result, pictures
        self.chain, self.warnings, self.notes = chain, result.warnings, result.notes
        self.parameters = {one.port: one for one in result.parameters}
        self.combinations = {one.text: (one.value, one.sigma) for one in result.combinations}
        self.correlation = result.correlation.copy()
        self.chi2_per_degree = result.chi2_per_degree

    def to_dict(self) -> dict[str, Any]:
        """The complete result as a dictionary, like the JSON of `imagechain fit --json`."""
        return fit_facts(self._result)

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write the parameters, errors and correlations (.json), or a report of the fit (.html).

        To write the network, use ``fitted.chain.save``.
        """
        file = Path(fspath(path))
        name = self.chain.name or "Chain"
        text = fit_content(self._result, file, network=name, pictures=self._pictures)
        write_text(file, text)
        return file

    def __repr__(self) -> str:
        return fit_text(self._result)


# Fitting a chain to pictures of a camera: files and arrays.

Picture = File | NDArray[Any]
_FREE = (
    "must be NODE.PARAM, a list of parameters, or a mapping from each parameter to (low, high) "
    "or None"
)


@plain_errors
def fit(
    chain: Chain | File,
    *,
    to: Picture | Sequence[Picture],
    free: str | Sequence[str] | Mapping[str, tuple[float, float] | None],
    band: int | None = None,
    precision: Precision = "single",
    tolerance: float | None = None,
    threads: int = 0,
) -> FittedChain:
    """Fit parameters of a chain to pictures of a real camera, as `imagechain fit` does.

    Parameters
    ----------
    chain : Chain or path
        A chain, a file, or the name of an example network; your own chain does not change.
    to : path or array, or a sequence of them
        Pictures of the camera: files, or arrays (rows, columns) or (frames, rows, columns). The
        samples must be proportional to the light, as the sensor delivers them, and correspond one
        to one to the samples of the chain's final picture.
    free : str, sequence of str, or mapping
        Parameters to fit: ``NODE.PARAM``, within its allowed range; or a mapping of parameters to
        ranges (low, high), or to None for the allowed range.
    band : int, optional
        Band or colour to use, counted from 0, in files with several bands.
    precision, tolerance, threads
        As for `Chain.run`.
    """
    own = chain if isinstance(chain, Chain) else open_chain(chain)
    engine, plan = own.planned()
    parameters = free_parameters(_texts(free), plan.network, engine.library, option="free")
    pictures = _pictures(to, band)
    result = fit_pictures(
        engine, plan, engine.work(Policy(precision, tolerance, threads)), free=parameters,
        pictures=pictures,
    )  # fmt: skip
    values = {
        f"{parameter.node}.{parameter.name}": one.used
        for parameter, one in zip(parameters, result.parameters, strict=True)
        if one.used is not None
    }
    return FittedChain(result, own.with_(values), tuple(file.name for file in pictures))


def _texts(free: Any) -> list[str]:
    """As the command takes them: ``NODE.PARAM``, or ``NODE.PARAM=LOW:HIGH``."""
    if isinstance(free, str):
        return [free]
    if not isinstance(free, Mapping):
        if isinstance(free, Sequence) and all(isinstance(one, str) for one in free):
            return list(free)
        raise ParameterError("free", free, _FREE)
    texts = []
    for name, ends in free.items():
        if ends is None:
            texts.append(str(name))
            continue
        try:
            low, high = map(float, ends)
        except (TypeError, ValueError):
            raise ParameterError("free", {name: ends}, _FREE) from None
        texts.append(f"{name}={low!r}:{high!r}")
    return texts


def _pictures(to: Any, band: int | None) -> list[PictureFile]:
    one = isinstance(to, str | PathLike | np.ndarray)
    if not one and not isinstance(to, Sequence):
        raise UsageError(
            f"to: {type(to).__name__} is not allowed; give a picture (a file or an array), or a "
            "list of pictures"
        )
    given = [to] if one else list(to)
    if not given:
        raise UsageError("to: the list is empty; give a picture (a file or an array)")
    if all(isinstance(one, str | PathLike) for one in given):
        return opened_pictures([Path(fspath(one)) for one in given], band=band)
    if any(isinstance(one, str | PathLike) for one in given):
        raise UsageError("to: files and arrays cannot be mixed; give only files or only arrays")
    if band is not None:
        raise UsageError("band applies to files only: arrays have no bands")
    return of_arrays(given)
