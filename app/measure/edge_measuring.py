"""Edges of pictures: searched for, measured one by one, and pooled by direction."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from app.measure.picture_measurement import FREQUENCIES, NEAR_DEG, MeasuredEdge, MtfCurve
from core.errors import DataError
from core.physics.measurement.edges.slanted_edge import SlantedEdge, falls_to, slanted_edge

Matrix = NDArray[np.float64]


def edges_of(
    *, picture: Matrix, number: int, check: Callable[[], None] = lambda: None
) -> tuple[MeasuredEdge, ...]:
    """The edges of one picture, measured.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns), finite.
    number : int
        Of the picture among those measured.
    check : callable
        Called between steps; may raise to stop.
    """
    rows, columns = picture.shape
    steps = [float(np.sum(np.abs(np.diff(picture, axis=axis)))) for axis in (1, 0)]
    along = steps[1] > steps[0]
    turned = np.ascontiguousarray(picture.T) if along else picture
    place = MeasuredEdge(
        number, (columns - 1) / 2, (rows - 1) / 2, 90.0 if along else 0.0,
        float(len(turned)), turned.shape[1] / 2, float(picture.min()), float(picture.max()), 0.0,
        None, "",
    )  # fmt: skip
    try:
        measured = slanted_edge(picture=turned, frequency=np.array(FREQUENCIES), check=check)
    except DataError as error:
        return (_refused(place, error.message),)
    return (_edge(place, measured, along),)


def _refused(edge: MeasuredEdge, why: str) -> MeasuredEdge:
    return replace(edge, why_not=why)


def _edge(edge: MeasuredEdge, measured: SlantedEdge, along: bool) -> MeasuredEdge:
    left, right = measured.spread.levels
    normal = math.degrees(math.atan(-measured.line.slope))
    angle = 90.0 - normal if along else normal
    if left > right:
        angle -= 180.0
    return replace(
        edge,
        angle_deg=angle,
        low=min(left, right),
        high=max(left, right),
        noise_sigma=measured.spread.noise,
        curve=curve_of(np.array(FREQUENCIES), measured.mtf, measured.error),
    )


def curve_of(
    frequency: NDArray[np.float64],
    mtf: NDArray[np.float64],
    sigma: NDArray[np.float64],
    *,
    edges: int = 1,
    scatter: float = 1.0,
) -> MtfCurve:
    """A curve with its MTF50, whose error is that of the MTF there over the slope."""
    middle = falls_to(frequency=frequency, mtf=mtf, level=0.5)
    error = None
    if middle is not None:
        slope = float(np.interp(middle, frequency, np.gradient(mtf, frequency)))
        error = float(np.interp(middle, frequency, sigma)) / max(abs(slope), 1e-12)
    return MtfCurve(frequency, mtf, sigma, middle, error, edges, scatter)


def pooled(edges: Sequence[MeasuredEdge], direction: str) -> tuple[MtfCurve | None, str]:
    """The MTF of all used edges whose normals lie near an axis, or the reason why there is none."""
    near = [edge for edge in edges if edge.direction == direction]
    used = [edge.curve for edge in near if edge.used and edge.curve is not None]
    if not used:
        return None, no_edge_reason(near, direction)
    weights = np.array([1.0 / np.maximum(curve.sigma, 1e-6) ** 2 for curve in used])
    total = weights.sum(axis=0)
    mtf = sum(w * curve.mtf for w, curve in zip(weights, used, strict=True)) / total
    return curve_of(np.array(FREQUENCIES), mtf, total**-0.5, edges=len(used)), ""


def no_edge_reason(near: Sequence[MeasuredEdge], direction: str) -> str:
    """Why there is no MTF in a direction."""
    across = "across" if direction == "x" else "along"
    if not near:
        return f"no edge whose normal lies within {NEAR_DEG:g}° of {direction} ({across}) was seen"
    whys = sorted({edge.why_not for edge in near})
    more = f" (and {len(whys) - 3} other reasons)" if len(whys) > 3 else ""
    many = "the one edge" if len(near) == 1 else f"none of {len(near)} edges"
    verb = "cannot be used" if len(near) == 1 else "can be used"
    return f"{many} that would give the MTF {across} {verb}: {'; '.join(whys[:3])}{more}"
