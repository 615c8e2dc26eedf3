"""Figures of a fit: real and simulated patches, edges overlaid, residuals, noise over the level."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.fit.edge_fit import EdgesAt
from app.fit.fit_result import FitResult, NoiseComparison
from app.fit.known_scene.scene_match import SceneFit
from app.report.drawing.picture_drawing import COLOURS, figure

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

MOST = 6  # edges that are drawn
_BIN = 0.25  # samples
_WIDE = 4.0  # deviations of a residual's grey levels


def drawn_edges(result: FitResult) -> list[int]:
    """Edges of all directions, no more than are drawn."""
    patches = result.fit.patches
    order = np.argsort([patch.angle_deg % 180.0 for patch in patches], kind="stable")
    places = np.linspace(0, len(order) - 1, min(MOST, len(order))).astype(np.intp)
    return [int(order[place]) for place in places]


def edges_of(result: FitResult) -> EdgesAt:
    """The edges of a fit that has some."""
    assert result.fit.edges is not None
    return result.fit.edges


def scene_png(scene: SceneFit) -> bytes:
    """The real picture, the simulated one, and their difference."""
    rows, columns = scene.real.shape
    with figure(10.0, min(3.6 * rows / columns, 8.0) + 0.5) as (drawn, out):
        axes = drawn.subplots(1, 3)
        low, high = (float(v) for v in np.quantile(scene.real, (0.001, 0.999)))
        left = (scene.real - scene.simulated) / scene.noise_sigma
        for axis, values, ends, words in (
            (axes[0], scene.real, (low, high), "real"),
            (axes[1], scene.simulated, (low, high), "simulated"),
            (axes[2], left, (-_WIDE, _WIDE), "difference, ±4 σ"),
        ):
            axis.imshow(values, cmap="gray", vmin=ends[0], vmax=ends[1], interpolation="nearest")
            axis.set_title(words, fontsize=10)
            axis.set_xticks([])
            axis.set_yticks([])
            axis.grid(visible=False)
    return out.getvalue()


def patches_png(result: FitResult) -> bytes:
    """For each edge drawn: the real patch, the simulated one, and what is left."""
    edges = drawn_edges(result)
    with figure(1.7 * len(edges) + 0.8, 5.6) as (drawn, out):
        axes = drawn.subplots(3, len(edges), squeeze=False)
        for column, edge in enumerate(edges):
            patch, at = result.fit.patches[edge], edges_of(result)
            count = len(patch.value)
            model, left = at.model[edge, :count], at.residual[edge, :count]
            low, high = float(patch.value.min()), float(patch.value.max())
            for axis, values, ends in (
                (axes[0, column], patch.value, (low, high)),
                (axes[1, column], model, (low, high)),
                (axes[2, column], left, (-_WIDE, _WIDE)),
            ):
                axis.imshow(
                    _image(patch.row, patch.column, values), cmap="gray", vmin=ends[0],
                    vmax=ends[1], interpolation="nearest",
                )  # fmt: skip
                axis.set_xticks([])
                axis.set_yticks([])
                axis.grid(visible=False)
            axes[0, column].set_title(f"{edge + 1}: {patch.angle_deg:.0f}°", fontsize=9)
        for row, words in enumerate(("real", "simulated", "difference, ±4 σ")):
            axes[row, 0].set_ylabel(words)
    return out.getvalue()


def spreads_png(result: FitResult) -> bytes:
    """Samples of the edges over their distance, with the chain's spread, and means of the rest."""
    edges = drawn_edges(result)
    with figure(10.0, 2.1 * len(edges) + 0.6) as (drawn, out):
        axes = drawn.subplots(len(edges), 2, squeeze=False, sharex=True)
        for row, edge in enumerate(edges):
            patch, at = result.fit.patches[edge], edges_of(result)
            count = len(patch.value)
            distance, spread = at.distance[edge, :count], at.spread[edge, :count]
            rest = at.residual[edge, :count] / at.weight[edge, :count] / at.step[edge]
            left, right = axes[row]
            left.plot(distance, spread + rest, ".", ms=1.5, color="#9aa5b1", zorder=1)
            order = np.argsort(distance)
            left.plot(distance[order], spread[order], color=COLOURS[0], lw=1.4, zorder=2)
            left.set_ylabel(f"edge {edge + 1}")
            place, mean, error = _means(distance, rest)
            right.errorbar(place, mean, error, fmt=".", ms=3, lw=0.8, color=COLOURS[0])
            right.axhline(0.0, color="#555555", lw=0.8)
        axes[0, 0].set_title("a. Samples and the fitted spread (of the step)", fontsize=10)
        axes[0, 1].set_title("b. Mean of what is left, with its error", fontsize=10)
        for axis in axes[-1]:
            axis.set_xlabel("distance along the normal (samples)")
    return out.getvalue()


def noise_png(noise: NoiseComparison) -> bytes:
    """Variance of a sample over the level, measured and by the network."""
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


def _image(row: NDArray[np.intp], column: NDArray[np.intp], values: Vector) -> Matrix:
    made = np.full((int(np.ptp(row)) + 1, int(np.ptp(column)) + 1), np.nan)
    made[row - row.min(), column - column.min()] = values
    return made


def _means(distance: Vector, rest: Vector) -> tuple[Vector, Vector, Vector]:
    """Means over equal distances: place, mean and standard error."""
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
