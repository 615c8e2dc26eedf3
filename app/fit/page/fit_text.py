"""A fit in rows of figures and lines of words, for the terminal and for a script."""

from __future__ import annotations

from app.fit.fit_result import FitResult, NoiseComparison
from app.measure.measurement_text import with_error
from app.run.readout_tables import columns, number_text
from core.names import in_line

NOT_DETERMINED = "not determined"
_LARGE = 100.0


def parameter_rows(result: FitResult) -> list[tuple[str, str, str]]:
    """Name, value with its standard error, and unit of each parameter; then what combinations."""
    rows = [
        (
            one.port,
            NOT_DETERMINED if one.value is None else with_error(one.value, one.sigma),
            "" if one.value is None else one.unit,
        )
        for one in result.parameters
    ]
    rows += [(one.text, with_error(one.value, one.sigma), one.unit) for one in result.combinations]
    return rows


def fit_text(result: FitResult) -> str:
    """The whole fit, as `imagechain fit` prints it."""
    chi2 = result.chi2_per_degree
    lines = [
        f"chi² per degree of freedom  {f'{chi2:.3f}' if chi2 < _LARGE else f'{chi2:.4g}'}  "
        f"(of {result.fit.misfit.degrees} degrees; 1: nothing but noise is left)"
    ]
    if isinstance(result.noise, NoiseComparison):
        how = "fitted too" if result.noise.fitted else "of the network as it is"
        ratio = number_text(float(f"{result.noise.ratio:.4g}"))
        lines.append(f"noise predicted over measured  {ratio}  ({how})")
    elif result.noise:
        lines.append(result.noise)
    lines += [*result.notes, *(f"warning: {line}" for line in result.warnings)]
    return "\n".join([columns(parameter_rows(result)), "", *map(in_line, lines)])
