"""Filtering a frame whose samples lie at other angles in flight in each of its columns.

Each column becomes that of the whole frame filtered at the column's own interval in flight. What
separates is exact at the cost of a whole frame: one transform along the scan serves all columns,
and in flight each has its own response. What does not separate is either summed up anew for every
interval, or blended from a few intervals between the smallest and the largest.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.evaluation.float_guard import require_finite
from core.evaluation.work import Work
from core.physics.sampling.platform_motion import scale_nodes_mrad, scale_weights
from core.transfer.planar_blocks import thin_product
from core.transfer.scan_lines import MirroredLines, Parts, PeriodicLines, ScanChain, ScanLines

Array = NDArray[Any]
Vector = NDArray[np.float64]
Method = Literal["nodes", "direct"]
MOST_NODES = 32
BLOCK_SAMPLES = 1 << 18
FREQUENCIES = 24  # along the scan and in flight, at which blended factors are tried
LAW_NODES = (4, 8, 12, 16, 24, 32)  # tried in turn
LEAST_COLUMNS = 64  # narrower blocks are copied in pieces shorter than a line of the cache


@dataclass(frozen=True)
class Filtered:
    """A frame of mixed sampling, and how it was made.

    `nodes` intervals were taken for what does not separate, 0 if there is no such factor.
    `response_error` is the largest error of the transfer function by blending, of those looked at,
    `picture_error` that in the picture, were all columns as far from a node as the last.
    """

    picture: Array
    nodes: int
    response_error: float = 0.0
    picture_error: float = 0.0


def filter_mixed(
    work: Work,
    image: Array,
    *,
    chain: ScanChain,
    intervals_mrad: Vector,
    method: Method,
    nodes: int | None = None,
    tolerance: float = 1e-5,
) -> Filtered:
    """Filter a frame, each column at its own interval in flight.

    What does not separate is blended from `nodes` intervals, by default as many as keep the largest
    error of the transfer function within the tolerance, or summed up for each in double precision.
    """
    frame = np.ascontiguousarray(image.T) if chain.turned else image
    direct = method == "direct" and bool(chain.product.planar)
    kind = MirroredLines if chain.edges == "reflect" else PeriodicLines
    lines = kind(work, chain, frame, np.float64 if direct else work.policy.dtype)
    if direct:
        parts, count = _summed(lines, intervals_mrad), len(np.unique(intervals_mrad))
        blend = Blend(parts, count)
    else:
        blend = _blended(lines, intervals_mrad, nodes, tolerance)
    responses = _responses(lines, intervals_mrad)
    picture = _delivered(lines, blend.parts, responses)
    error = 0.0
    if blend.gap is not None:
        error = float(np.max(np.abs(_delivered(lines, blend.gap, responses))))
    picture += np.asarray(lines.mean * chain.product.at_zero(work), picture.dtype)
    if chain.turned:
        picture = np.ascontiguousarray(picture.T)
    picture = picture.astype(work.policy.dtype, copy=False)
    return Filtered(picture, blend.count, blend.response_error, error)


@dataclass(frozen=True)
class Blend:
    """Columns' spectra in flight, and those of what the blend lacks at the smallest interval."""

    parts: Parts
    count: int = 0
    gap: Parts | None = None
    response_error: float = 0.0


def _summed(lines: ScanLines, intervals_mrad: Vector) -> Parts:
    """Every column summed directly along the scan; equal intervals share their response."""
    groups, which = np.unique(intervals_mrad, return_inverse=True)
    columns = lines.columns
    members = [np.flatnonzero(which == group) for group in range(len(groups))]
    shape = (len(lines.flight), columns)
    count = 1 if lines.symmetric else 2
    parts = tuple(np.empty(shape, lines.kind) for _ in range(count))
    height = max(1, BLOCK_SAMPLES // columns)

    def one(group: int) -> None:
        for start in range(0, shape[0], height):
            lines.work.check()
            block = slice(start, start + height)
            block_parts = lines.evaluated(float(groups[group]), block)
            for part, values in zip(parts, block_parts, strict=True):
                part[block, members[group]] = lines.summed(values, members[group])

    lines.work.for_each(one, range(len(groups)))
    return parts


def _blended(
    lines: ScanLines, intervals_mrad: Vector, nodes: int | None, tolerance: float
) -> Blend:
    """Spectra at a few intervals, weighted in each column; exact without planar factors."""
    if not lines.planar:
        return Blend((lines.unscanned(lines.values),))
    last = float(intervals_mrad.min())
    if last == float(intervals_mrad.max()):
        return Blend(tuple(lines.unscanned(part) for part in lines.with_planar(last)), 1)
    if nodes is None:
        nodes, error = _enough(lines, intervals_mrad, tolerance)
    else:
        error = _error(lines, intervals_mrad, nodes)
    at = scale_nodes_mrad(intervals_mrad=intervals_mrad, count=nodes)
    weights = scale_weights(nodes_mrad=at, intervals_mrad=intervals_mrad)
    at_last = scale_weights(nodes_mrad=at, intervals_mrad=[last])[:, 0]
    gap = [lines.unscanned(part) for part in lines.with_planar(last)]
    parts = [np.zeros_like(part) for part in gap]
    for interval, weight, share in zip(at, weights, at_last, strict=True):
        lines.work.check()
        row = weight.astype(lines.real)
        for index, part in enumerate(lines.with_planar(float(interval))):
            part_alone = lines.unscanned(part)
            gap[index] -= part_alone * lines.real.type(share)
            parts[index] += np.multiply(part_alone, row, out=part_alone)
    return Blend(tuple(parts), nodes, tuple(gap), error)


def _enough(lines: ScanLines, intervals_mrad: Vector, tolerance: float) -> tuple[int, float]:
    """Least number of nodes whose blend of the transfer function keeps to the tolerance."""
    for count in range(1, MOST_NODES + 1):
        error = _error(lines, intervals_mrad, count)
        if error <= tolerance:
            break
    return count, error


def _error(lines: ScanLines, intervals_mrad: Vector, count: int) -> float:
    """Largest error of the whole transfer function between the nodes."""
    work, chain = lines.work, lines.chain
    scan = np.linspace(0.0, float(np.abs(lines.scan).max()), FREQUENCIES)
    flight = np.linspace(0.0, 0.5, FREQUENCIES)
    if not lines.symmetric:
        flight = np.concatenate([flight, -flight[flight > 0.0]])
    nodes = scale_nodes_mrad(intervals_mrad=intervals_mrad, count=count)
    tried = _between(intervals_mrad, count)
    weights = scale_weights(nodes_mrad=nodes, intervals_mrad=tried)
    at_nodes = np.array([chain.plane(work, scan, flight / float(node)) for node in nodes])
    along_scan = np.abs(chain.along_scan(work, scan))
    largest = 0.0
    for place, interval in enumerate(tried):
        work.check()
        exact = chain.plane(work, scan, flight / float(interval))
        gap = np.abs(exact - np.tensordot(weights[:, place], at_nodes, 1))
        own = np.abs(chain.in_flight(work, flight / float(interval)))
        largest = max(largest, float(np.max(gap * along_scan * own[:, np.newaxis])))
    return largest


def _delivered(lines: ScanLines, parts: Parts, responses: Array) -> Array:
    """Each column times its own response in flight, and transformed back."""
    rows, columns = lines.chain.shape
    picture = np.empty((rows, columns), lines.real)
    step = max(LEAST_COLUMNS, BLOCK_SAMPLES // rows)

    def one(start: int) -> None:
        block = slice(start, start + step)
        spectra = tuple(np.ascontiguousarray(part[:, block]) for part in parts)
        picture[:, block] = lines.samples(spectra, responses[:, block])

    lines.work.for_each(one, range(0, columns, step))
    require_finite(picture)
    return picture


def _responses(lines: ScanLines, intervals_mrad: Vector) -> Array:
    """Response in flight of each column, shape (frequencies in flight, columns).

    Laws are smooth in the scale: they are evaluated at a few intervals and interpolated, to the
    samples' rounding (7 ms for 55 at 1024²), or else at each.
    """
    groups, which = np.unique(intervals_mrad, return_inverse=True)
    allowed = 4.0 * float(np.finfo(lines.real).eps)
    for count in LAW_NODES:
        if count >= len(groups):
            break
        nodes, tried = scale_nodes_mrad(intervals_mrad=groups, count=count), _between(groups, count)
        at_nodes = _laws(lines, nodes)
        between = scale_weights(nodes_mrad=nodes, intervals_mrad=tried)
        blended = thin_product(at_nodes, between.astype(at_nodes.dtype))
        if np.max(np.abs(blended - _laws(lines, tried))) <= allowed:
            weights = scale_weights(nodes_mrad=nodes, intervals_mrad=intervals_mrad)
            return lines.narrow(thin_product(at_nodes, weights.astype(at_nodes.dtype)))
    return lines.narrow(_laws(lines, groups))[:, which]


def _laws(lines: ScanLines, intervals_mrad: Vector) -> Array:
    """The laws in flight themselves, shape (frequencies in flight, intervals)."""
    frequency = np.divide.outer(lines.flight, intervals_mrad)
    return lines.chain.in_flight(lines.work, frequency.ravel()).reshape(frequency.shape)


def _between(intervals_mrad: Vector, count: int) -> Vector:
    """Where a blend of so many nodes errs most: both ends, and half way between nodes."""
    first, last = float(intervals_mrad.max()), float(intervals_mrad.min())
    middle, reach = 0.5 * (1.0 / last + 1.0 / first), 0.5 * (1.0 / last - 1.0 / first)
    intervals = 1.0 / (middle - reach * np.cos(np.pi * np.arange(count + 1) / count))
    return np.asarray(np.clip(intervals, last, first))
