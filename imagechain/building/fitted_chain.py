"""The result of `imagechain.fit`: values with their errors, and the chain with these values."""

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.fit.fit_page import fit_facts, fit_text
from app.fit.fit_result import FitResult
from app.fit.free_parameter import free_parameters
from app.fit.picture_fit import FittedPictures, fit_pictures, read_pictures
from app.run.readout_tables import json_text
from core.atomic import write_text
from core.errors import ParameterError, UsageError
from core.evaluation.work import Policy, Precision
from imagechain.building.chain import Chain
from imagechain.building.chain import open as open_chain
from imagechain.building.measure_pictures import frames_of_arrays, limits_of_arrays
from imagechain.parts.plain_errors import plain_errors
from nodes.files.common.file_format import HTML, JSON, suffixes


class FittedChain:
    """Parameters of a chain, fitted to pictures.

    `parameters` gives the `value` and the standard error `sigma` of each parameter; both are None
    if the pictures do not determine the parameter. `combinations` gives the value and standard
    error of each combination of parameters that cannot be separated. `warnings` lists what to check
    before you trust the values; `notes` lists what was fitted and assumed. `correlation` is the
    correlation matrix of the errors, in the order of `parameters`, with NaN for undetermined
    entries. `chi2_per_degree` is the reduced χ²: 1 if the residuals are only noise. `chain` is the
    chain with the fitted values, to run and to save.
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
        content: dict[str, Any] = fit_facts(self._result)
        return content

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write the parameters, errors and correlations (.json), or a report of the fit (.html).

        To write the network, use ``fitted.chain.save``.
        """
        file = Path(fspath(path))
        if JSON.matches(file):
            text = json_text(fit_facts(self._result))
        elif HTML.matches(file):
            # Imported only where a page is written: matplotlib and jinja2.
            from app.fit.fit_page import fit_page

            name = self.chain.name or "Chain"
            text = fit_page(self._result, network=name, pictures=self._pictures)
        else:
            allowed = ", ".join(suffixes(JSON, HTML))
            raise UsageError(f"{file}: the file's name must end in {allowed}")
        write_text(file, text)
        return file

    def __repr__(self) -> str:
        return fit_text(self._result)


# Fitting a chain to pictures of a camera: files and arrays.

File = str | PathLike[str]
Picture = File | NDArray[Any]
_FREE = "NODE.PARAM, a list of parameters, or a mapping of parameters to (low, high) or None"


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
        A chain, a file, or the name of a shipped network; it does not change.
    to : path or array, or a sequence of them
        Pictures of the camera: files, or arrays (rows, columns) or (frames, rows, columns); linear,
        as the sensor gives them. Each sample corresponds to one sample of the chain's final
        picture.
    free : str, sequence of str, or mapping
        Parameters to fit: ``NODE.PARAM``, within its allowed range; or a mapping of parameters to
        ranges (low, high), or to None for the allowed range.
    band : int, optional
        Band or colour to use, if the files have several.
    precision, tolerance, threads
        As for `Chain.run`.
    """
    own = chain if isinstance(chain, Chain) else open_chain(chain)
    engine, plan = own.planned()
    parameters = free_parameters(_texts(free), plan.network, engine.library, option="free")
    names, pictures = _pictures(to, band)
    result = fit_pictures(
        engine, plan, engine.work(Policy(precision, tolerance, threads)), free=parameters,
        pictures=pictures,
    )  # fmt: skip
    values = {
        f"{parameter.node}.{parameter.name}": one.used
        for parameter, one in zip(parameters, result.parameters, strict=True)
        if one.used is not None
    }
    return FittedChain(result, own.with_(values), names)


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


def _pictures(to: Any, band: int | None) -> tuple[tuple[str, ...], FittedPictures]:
    one = isinstance(to, str | PathLike | np.ndarray)
    if not one and not isinstance(to, Sequence):
        raise UsageError("to: give a picture (a file or an array), or a list of pictures")
    given = [to] if one else list(to)
    if not given:
        raise UsageError("to: give a picture (a file or an array); the list is empty")
    if all(isinstance(one, str | PathLike) for one in given):
        paths = [Path(fspath(one)) for one in given]
        return tuple(map(str, paths)), read_pictures(paths, band=band)
    if any(isinstance(one, str | PathLike) for one in given):
        raise UsageError("to: give files or arrays, not both")
    if band is not None:
        raise UsageError("band applies to files only: arrays have no bands")
    names = tuple(f"array {number}" for number in range(1, len(given) + 1))
    frames = [
        (name, frame)
        for name, own in zip(names, frames_of_arrays(given), strict=True)
        for frame in own
    ]
    limits = limits_of_arrays(given)
    taken = FittedPictures(tuple(n for n, _ in frames), tuple(f for _, f in frames), limits)
    return names, taken
