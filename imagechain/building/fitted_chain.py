"""What `imagechain.fit` gives: values with their errors, and the chain that has them."""

from __future__ import annotations

import json
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.fit.fit_result import FitResult, FittedParameter
from app.fit.page.fit_json import fit_json
from app.fit.page.fit_text import fit_text
from core.atomic import write_text
from core.errors import UsageError
from imagechain.building.chain import Chain
from imagechain.common.plain_errors import plain_errors
from nodes.files.common.file_format import HTML, JSON, suffixes


class FittedChain:
    """Parameters of a chain as fitted to pictures.

    `parameters` has each one's `value` and `sigma`, its standard error, both None where the
    pictures do not determine it; `combinations` what is known of those that cannot be told apart;
    `warnings` what to know before the values are believed; `chain` is the chain with the values.
    """

    def __init__(self, result: FitResult, chain: Chain, pictures: tuple[str, ...]) -> None:
        self._result, self._chain, self._pictures = result, chain, pictures

    @property
    def chain(self) -> Chain:
        """The chain with the fitted values, to run and to save."""
        return self._chain

    @property
    def parameters(self) -> dict[str, FittedParameter]:
        """Value, standard error and unit of each, by ``NODE.PARAM``."""
        return {one.port: one for one in self._result.parameters}

    @property
    def correlation(self) -> NDArray[np.float64]:
        """Of the errors, in the order of `parameters`; NaN of those that are not determined."""
        return self._result.correlation.copy()

    @property
    def combinations(self) -> dict[str, tuple[float, float]]:
        """Value and standard error of what is known of parameters with one effect, by its text."""
        return {one.text: (one.value, one.sigma) for one in self._result.combinations}

    @property
    def chi2_per_degree(self) -> float:
        """χ² per degree of freedom: 1 where the chain leaves nothing but noise."""
        return self._result.chi2_per_degree

    @property
    def warnings(self) -> tuple[str, ...]:
        """One line each."""
        return self._result.warnings

    @property
    def notes(self) -> tuple[str, ...]:
        """What was fitted, and what assumed."""
        return self._result.notes

    def to_dict(self) -> dict[str, Any]:
        """Everything, as `imagechain fit --json` writes it."""
        content: dict[str, Any] = json.loads(fit_json(self._result))
        return content

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write parameters, errors and correlations (.json), or the page of the fit (.html).

        The network is written by ``fitted.chain.save``.

        Raises
        ------
        ImagechainError
            Another suffix, or the file cannot be written.
        """
        file = Path(fspath(path))
        if JSON.matches(file):
            text = fit_json(self._result)
        elif HTML.matches(file):
            # Imported only where a page is written: matplotlib and jinja2.
            from app.fit.page.fit_page import fit_page

            name = self._chain.name or "Chain"
            text = fit_page(self._result, network=name, pictures=self._pictures)
        else:
            allowed = ", ".join(suffixes(JSON, HTML))
            raise UsageError(f"{file}: the file's name must end in {allowed}")
        write_text(file, text)
        return file

    def __repr__(self) -> str:
        return fit_text(self._result)
