"""A fit as one page that needs no other file, as JSON, and in words."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from app.fit.fit_result import FitResult, NoiseComparison
from app.measure.measurement_text import with_error
from app.report import html_page as html
from app.report.drawing.picture_drawing import COLOURS, figure, number, short
from app.run.terminal import columns, json_text, number_text, values_of
from core.arrays import Vector
from core.errors import UsageError, in_line, listed, several
from nodes.files.file_format import HTML, JSON, suffixes

_CHI2 = "χ² per degree".replace(" ", "\N{NO-BREAK SPACE}")


def fit_content(
    result: FitResult, path: Path, *, network: str, pictures: Sequence[Path | str]
) -> str:
    """What a file of that suffix holds: .json the figures, .html a page."""
    if JSON.matches(path):
        return json_text(fit_facts(result))
    if HTML.matches(path):
        return fit_page(result, network=network, pictures=tuple(map(str, pictures)))
    ends = listed(suffixes(JSON, HTML), "or")
    raise UsageError(f"{path}: the file's name must end in {ends}")


def fit_page(result: FitResult, *, network: str, pictures: tuple[str, ...]) -> str:
    first = Path(pictures[0]).name
    more = f" and {len(pictures) - 1} more" if len(pictures) > 1 else ""
    title = f"{network} fitted to {first}{more}"
    misfit = result.fit.misfit
    lines = [*(f"Warning: {line}." for line in result.warnings), *(f"{n}." for n in result.notes)]
    heads = ("parameter", "value ± standard error", "unit", "value before the fit")
    rows = [_row(result, index) for index in range(len(result.parameters))]
    blocks = [
        html.paragraph(
            # No-break spaces: what belongs together stays in one line.
            f"{several(len(result.fit.patches), 'edge')}. {_CHI2} of freedom: "
            f"{short(result.chi2_per_degree)} for all residuals "
            f"({several(misfit.degrees, 'degree')} of freedom), "
            f"{short(misfit.shape_per_degree)} for the shape of the edges alone; 1 means that the "
            "residuals are only noise.",
            "lead",
        ),
        html.grid(heads, rows, numbers=(1, 3), kind="fitted"),
        html.items(f"{line[:1].upper()}{line[1:]}" for line in lines) if lines else "",
        _combinations(result),
        _correlation(result),
        _pictures(result),
        _noise(result),
    ]
    return html.page(title, blocks)


def _pictures(result: FitResult) -> str:
    return (
        html.heading(2, "Edges")
        + html.drawn(
            patches_png(result),
            "Patches of the picture, the same patches from the fitted network, and their "
            "difference in units of the noise's standard deviation. If the network is right, "
            "the difference is only noise; a pattern along the edge means that the network lacks "
            "an effect. Above each patch: the direction of the edge's normal.",
            "real and simulated patches",
        )
        + html.drawn(
            spreads_png(result),
            "a: samples against distance from the edge, scaled from 0 (dark level) to 1 (bright "
            "level), and the edge spread of the fitted chain. b: mean residuals in "
            "quarter-sample bins, on the same scale; pure noise scatters about 0 within the error "
            "bars.",
            "overlaid edges and residuals",
        )
        + _table(result)
    )


def _row(result: FitResult, index: int) -> tuple[str, ...]:
    one, before = result.parameters[index], number(result.fit.free[index].present)
    value = NOT_DETERMINED if one.value is None else with_error(one.value, one.sigma)
    return one.port, value, one.unit, before


def _combinations(result: FitResult) -> str:
    if not result.combinations:
        return ""
    rows = [(one.text, with_error(one.value, one.sigma), one.unit) for one in result.combinations]
    heads = ("combination", "value ± standard error", "unit")
    return html.heading(2, "Combinations of parameters that cannot be separated") + html.grid(
        heads, rows, numbers=(1,), kind="fitted"
    )


def _correlation(result: FitResult) -> str:
    known = [i for i, one in enumerate(result.parameters) if one.value is not None]
    names = [result.parameters[i].port for i in known]
    if len(names) < 2:
        return ""
    rows = [
        (name, *(f"{value:.3f}" if math.isfinite(value) else "" for value in row[known]))
        for name, row in zip(names, result.correlation[known], strict=True)
    ]
    numbers = tuple(range(1, len(names) + 1))
    return html.heading(2, "Correlation of errors") + html.grid(("", *names), rows, numbers=numbers)


def _table(result: FitResult) -> str:
    drawn = set(drawn_edges(result))
    rows = []
    for index, patch in enumerate(result.fit.patches):
        chi2 = float(result.fit.edges.residual[index] @ result.fit.edges.residual[index])
        name = f"{index + 1}{'' if index in drawn else ' (not drawn)'}"
        place = (f"{each:.1f}" for each in (patch.edge.x, patch.edge.y, patch.edge.angle_deg))
        step, count = short(float(result.fit.edges.step[index])), len(patch.value)
        rows.append((name, *place, str(count), step, f"{chi2 / count:.3f}"))
    heads = ("edge", "column", "row", "normal (°)", "samples", "step", "χ² per sample")
    return html.grid(heads, rows, numbers=tuple(range(1, 7)))


def _noise(result: FitResult) -> str:
    if not result.noise:
        return ""
    blocks = html.heading(2, "Noise")
    if not isinstance(result.noise, NoiseComparison):
        return blocks + html.paragraph(f"{result.noise[:1].upper()}{result.noise[1:]}.")
    how = (
        "fitted together with the edges"
        if result.noise.fitted
        else "not fitted: no free parameter affects the noise"
    )
    caption = (
        "Sample variance in flat areas against level, with its standard error, and the prediction "
        f"from the network's noise budget ({how})."
    )
    return blocks + html.drawn(noise_png(result.noise), caption, "noise against level")


# Figures of a fit: real and simulated patches, edges overlaid, residuals, noise over the level.


MOST = 6  # edges that are drawn
_BIN = 0.25  # samples
_WIDE = 4.0  # deviations of a residual's grey levels


def drawn_edges(result: FitResult) -> list[int]:
    patches = result.fit.patches
    order = np.argsort([patch.edge.angle_deg % 180.0 for patch in patches], kind="stable")
    places = np.linspace(0, len(order) - 1, min(MOST, len(order))).astype(np.intp)
    return [int(order[place]) for place in places]


def patches_png(result: FitResult) -> bytes:
    edges = drawn_edges(result)
    with figure(1.7 * len(edges) + 0.8, 5.6) as (drawn, out):
        axes = drawn.subplots(3, len(edges), squeeze=False)
        for column, edge in enumerate(edges):
            patch, at = result.fit.patches[edge], result.fit.edges
            count = len(patch.value)
            model, left = at.model[edge, :count], at.residual[edge, :count]
            low, high = float(patch.value.min()), float(patch.value.max())
            for axis, values, ends in (
                (axes[0, column], patch.value, (low, high)),
                (axes[1, column], model, (low, high)),
                (axes[2, column], left, (-_WIDE, _WIDE)),
            ):
                row, place = patch.row - patch.row.min(), patch.column - patch.column.min()
                image = np.full((int(row.max()) + 1, int(place.max()) + 1), np.nan)
                image[row, place] = values
                axis.imshow(image, cmap="gray", vmin=ends[0], vmax=ends[1], interpolation="nearest")
                axis.set_xticks([])
                axis.set_yticks([])
                axis.grid(visible=False)
            axes[0, column].set_title(f"{edge + 1}: {patch.edge.angle_deg:.0f}°", fontsize=9)
        for row, words in enumerate(("real", "simulated", "difference, ±4 σ")):
            axes[row, 0].set_ylabel(words)
    return out.getvalue()


def spreads_png(result: FitResult) -> bytes:
    edges = drawn_edges(result)
    with figure(10.0, 2.1 * len(edges) + 0.6) as (drawn, out):
        axes = drawn.subplots(len(edges), 2, squeeze=False, sharex=True)
        for row, edge in enumerate(edges):
            distance, spread, rest = result.fit.edges.profile(edge, result.fit.patches[edge])
            left, right = axes[row]
            left.plot(distance, spread + rest, ".", ms=1.5, color="#9aa5b1", zorder=1)
            order = np.argsort(distance)
            left.plot(distance[order], spread[order], color=COLOURS[0], lw=1.4, zorder=2)
            left.set_ylabel(f"edge {edge + 1}")
            place, mean, error = _means(distance, rest)
            right.errorbar(place, mean, error, fmt=".", ms=3, lw=0.8, color=COLOURS[0])
            right.axhline(0.0, color="#555555", lw=0.8)
        axes[0, 0].set_title("a. Samples and fitted ESF (fraction of the step)", fontsize=10)
        axes[0, 1].set_title("b. Mean residual, with its error", fontsize=10)
        for axis in axes[-1]:
            axis.set_xlabel("distance along the normal (samples)")
    return out.getvalue()


def noise_png(noise: NoiseComparison) -> bytes:
    level = np.array([one.level for one in noise.measured])
    order = np.argsort(level)
    variance = np.array([one.variance for one in noise.measured])
    error = np.array([one.variance_error for one in noise.measured])
    predicted = np.array(noise.predicted)
    with figure(6.5, 3.6) as (drawn, out):
        axis = drawn.subplots()
        axis.errorbar(level, variance, error, fmt="o", ms=3, color=COLOURS[0], label="picture")
        axis.plot(level[order], predicted[order], color=COLOURS[1], label="network")
        axis.set_xlabel("level")
        axis.set_ylabel("variance of a sample")
        axis.legend()
    return out.getvalue()


def _means(distance: Vector, rest: Vector) -> tuple[Vector, Vector, Vector]:
    place = np.floor(distance / _BIN).astype(np.intp)
    first = int(place.min())
    count = np.bincount(place - first)
    kept = count >= 4
    total = np.bincount(place - first, rest)
    square = np.bincount(place - first, rest**2)
    number = count[kept].astype(np.float64)
    mean = total[kept] / number
    variance = np.maximum(square[kept] / number - mean**2, 0.0)
    middle = np.asarray((np.flatnonzero(kept) + first + 0.5) * _BIN, np.float64)
    error = np.asarray(np.sqrt(variance / (number - 1.0)), np.float64)
    return middle, np.asarray(mean, np.float64), error


# A fit's result as a JSON file.


def fit_facts(result: FitResult) -> dict[str, Any]:
    """All that is known as plain data; what is not is null."""
    content: dict[str, Any] = {
        "format": "imagechain-fit",
        "version": 1,
        "parameters": {
            one.port: values_of(one, "value", "sigma", "unit") for one in result.parameters
        },
        "correlation": [[_number(value) for value in row] for row in result.correlation],
        "chi2_per_degree": _number(result.chi2_per_degree),
        "combinations": [
            {
                "expression": one.text,
                "value": _number(one.value),
                "sigma": _number(one.sigma),
                "unit": one.unit,
            }
            for one in result.combinations
        ],
        "warnings": list(result.warnings),
        "notes": list(result.notes),
    }
    if isinstance(result.noise, NoiseComparison):
        pairs = zip(result.noise.measured, result.noise.predicted, strict=True)
        levels = [
            {**values_of(one, "level", "variance", "variance_error"), "predicted": predicted}
            for one, predicted in pairs
        ]
        content["noise"] = {"fitted": result.noise.fitted, "levels": levels}
    elif result.noise:
        content["noise"] = {"reason": result.noise}
    return content


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


# A fit in rows of figures and lines of words, for the terminal and for a script.

NOT_DETERMINED = "not determined"
_LARGE = 100.0


def parameter_rows(result: FitResult) -> list[tuple[str, str, str]]:
    """Name, value with its standard error, and unit of each parameter; then what combinations."""
    rows = [
        (one.port, NOT_DETERMINED, "")
        if one.value is None
        else (one.port, with_error(one.value, one.sigma), one.unit)
        for one in result.parameters
    ]
    return rows + [(c.text, with_error(c.value, c.sigma), c.unit) for c in result.combinations]


def fit_text(result: FitResult) -> str:
    chi2 = result.chi2_per_degree
    lines = [
        f"chi² per degree of freedom  {f'{chi2:.3f}' if chi2 < _LARGE else f'{chi2:.4g}'}  "
        f"({several(result.fit.misfit.degrees, 'degree')} of freedom; "
        "1 if the residuals are only noise)"
    ]
    if isinstance(result.noise, NoiseComparison):
        how = "noise fitted" if result.noise.fitted else "noise not fitted"
        ratio = number_text(float(f"{result.noise.ratio:.4g}"))
        lines.append(f"rms noise, predicted / measured  {ratio}  ({how})")
    elif result.noise:
        lines.append(result.noise)
    lines += [*result.notes, *(f"warning: {line}" for line in result.warnings)]
    return "\n".join([columns(parameter_rows(result)), "", *map(in_line, lines)])
