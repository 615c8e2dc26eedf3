"""A fit as one page that needs no other file."""

from __future__ import annotations

import math
from pathlib import Path

from app.fit.fit_result import FitResult, NoiseComparison
from app.fit.page.fit_drawing import (
    drawn_edges,
    edges_of,
    noise_png,
    patches_png,
    scene_png,
    spreads_png,
)
from app.fit.page.fit_text import NOT_DETERMINED
from app.measure.measurement_text import with_error
from app.report.blocks import Block, Drawn, Grid, Heading, Items, Text
from app.report.drawing.printed_numbers import number
from app.report.html_page import html_page

_CHI2 = "χ² per degree".replace(" ", "\N{NO-BREAK SPACE}")


def fit_page(result: FitResult, *, network: str, pictures: tuple[str, ...]) -> str:
    """The page as HTML; `network` and `pictures` are names for its title."""
    first = Path(pictures[0]).name
    more = f" and {len(pictures) - 1} more" if len(pictures) > 1 else ""
    title = f"{network} fitted to {first}{more}"
    misfit = result.fit.misfit
    lines = [*(f"Warning: {line}." for line in result.warnings), *(f"{n}." for n in result.notes)]
    blocks: list[Block] = [
        Heading(1, title),
        Text(
            # No-break spaces: what belongs together stays in one line.
            f"{_fitted(result)}, {misfit.degrees} degrees of freedom, "
            f"{_CHI2}\N{NO-BREAK SPACE}{number(_short(result.chi2_per_degree))} (1: nothing but "
            "noise is left).",
            "lead",
        ),
        Grid(
            ("parameter", "value, with its standard error", "unit", "in the network before"),
            [_row(result, index) for index in range(len(result.parameters))],
            numbers=(1, 3),
            kind="fitted",
        ),
        *([Items(tuple(f"{line[:1].upper()}{line[1:]}" for line in lines))] if lines else []),
        *_combinations(result),
        *_correlation(result),
        *_pictures(result),
        *_noise(result),
    ]
    return html_page(title, blocks)


def _fitted(result: FitResult) -> str:
    if result.scene is not None:
        return "The whole picture"
    count = len(result.fit.patches)
    shape = number(_short(result.fit.misfit.shape_per_degree))
    edges = "1 edge" if count == 1 else f"{count} edges"
    return f"{edges} (what is left in their shape: {_CHI2}\N{NO-BREAK SPACE}{shape})"


def _pictures(result: FitResult) -> list[Block]:
    """What of the picture was fitted, beside what the network gives."""
    if result.scene is not None:
        caption = (
            "The picture, the fitted network's where the picture has it, and the difference in "
            "standard deviations of the noise."
        )
        return [Heading(2, "Picture"), Drawn(scene_png(result.scene), caption, "pictures compared")]
    return [
        Heading(2, "Edges"),
        Drawn(
            patches_png(result),
            "Patches of the picture as they are, as the fitted network gives them, and the "
            "difference in standard deviations of the noise: grain alone where the network is "
            "right, a pattern along the edge where it lacks something. Above, the direction of the "
            "normal.",
            "real and simulated patches",
        ),
        Drawn(
            spreads_png(result),
            "a: samples by their distance from the edge, from the dark level 0 to the bright one "
            "1, with the spread of the fitted chain. b: means of what is left over a quarter of a "
            "sample; noise alone would lie about 0 within its errors.",
            "edges overlaid and residuals",
        ),
        *_table(result),
    ]


def _short(value: float) -> float:
    return float(f"{value:.4g}")


def _row(result: FitResult, index: int) -> tuple[str, ...]:
    one, before = result.parameters[index], number(result.fit.free[index].present)
    value = NOT_DETERMINED if one.value is None else with_error(one.value, one.sigma)
    return one.port, value, one.unit, before


def _combinations(result: FitResult) -> list[Block]:
    if not result.combinations:
        return []
    rows = [(one.text, with_error(one.value, one.sigma), one.unit) for one in result.combinations]
    heads = ("combination", "value, with its standard error", "unit")
    return [
        Heading(2, "Known of parameters that cannot be told apart"),
        Grid(heads, rows, numbers=(1,), kind="fitted"),
    ]


def _correlation(result: FitResult) -> list[Block]:
    known = [i for i, one in enumerate(result.parameters) if one.value is not None]
    names = [result.parameters[i].port for i in known]
    if len(names) < 2:
        return []
    rows = [
        (name, *(f"{value:.3f}" if math.isfinite(value) else "" for value in row[known]))
        for name, row in zip(names, result.correlation[known], strict=True)
    ]
    numbers = tuple(range(1, len(names) + 1))
    return [Heading(2, "Correlation of errors"), Grid(("", *names), rows, numbers=numbers)]


def _table(result: FitResult) -> list[Block]:
    drawn = set(drawn_edges(result))
    rows = []
    for index, patch in enumerate(result.fit.patches):
        chi2 = float(edges_of(result).residual[index] @ edges_of(result).residual[index])
        rows.append(
            (
                f"{index + 1}{'' if index in drawn else ' (not drawn)'}",
                f"{patch.x:.1f}",
                f"{patch.y:.1f}",
                f"{patch.angle_deg:.1f}",
                str(len(patch.value)),
                number(_short(float(edges_of(result).step[index]))),
                f"{chi2 / len(patch.value):.3f}",
            )
        )
    heads = ("edge", "column", "row", "normal (°)", "samples", "step", "χ² per sample")
    return [Grid(heads, rows, numbers=tuple(range(1, 7)))]


def _noise(result: FitResult) -> list[Block]:
    if not result.noise:
        return []
    blocks: list[Block] = [Heading(2, "Noise")]
    if not isinstance(result.noise, NoiseComparison):
        return [*blocks, Text(f"{result.noise[:1].upper()}{result.noise[1:]}.")]
    how = "fitted at once with the edges" if result.noise.fitted else "no free parameter changes it"
    caption = (
        "Variance of a sample in flat areas over their level, with its error, and what the "
        f"network's noise budget predicts there ({how})."
    )
    return [*blocks, Drawn(noise_png(result.noise), caption, "noise over the level")]
