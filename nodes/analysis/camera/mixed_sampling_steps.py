"""Steps of Line by Line: the frame of mixed sampling, and how far the whole-image way is off."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from core.chain.results import CurveData, Series, TableData, TableRow
from core.evaluation.recipes import ends_lineage
from core.evaluation.work import Work
from core.filtering.mixed_sampling import Filtered, Method, filter_mixed
from core.filtering.scan_chain import ScanChain
from core.transfer.factors import Factor
from core.transfer.grid import Edges, Grid
from core.transfer.product import Product

Array = NDArray[Any]
Scan = Literal["x", "y"]


@ends_lineage
def mixed(
    work: Work,
    image: Array,
    *,
    factors: tuple[Factor, ...],
    grid: Grid,
    edges: Edges,
    scan: Scan,
    intervals_mrad: tuple[float, ...],
    method: Method,
    nodes: int | None,
    tolerance: float,
) -> Filtered:
    """The frame, each column at its own interval in flight."""
    return filter_mixed(
        work,
        image,
        chain=ScanChain(Product(factors), grid, edges, scan),
        intervals_mrad=np.array(intervals_mrad),
        method=method,
        nodes=nodes,
        tolerance=tolerance,
    )


@ends_lineage
def picture_of(_: Work, filtered: Filtered) -> Array:
    """The samples."""
    return filtered.picture


@ends_lineage
def by_view_angle(
    _: Work, picture: Array, whole: Array, *, scan: Scan, view_angles_rad: tuple[float, ...]
) -> CurveData:
    """Rms and largest difference at each view angle, percent of the whole picture's range."""
    rms, largest = _along_flight(picture, whole, scan)
    percent = _percent(_range(whole))
    angles = np.degrees(view_angles_rad)
    return CurveData(
        "Line by line less whole image",
        "view angle from nadir (°)",
        "difference (% of range)",
        (
            Series("largest", angles, largest * percent),
            Series("rms", angles, rms * percent),
        ),
    )


@ends_lineage
def difference_table(
    _: Work,
    filtered: Filtered,
    picture: Array,
    whole: Array,
    *,
    scan: Scan,
    view_angles_rad: tuple[float, ...],
    intervals_mrad: tuple[float, ...],
    unit: str,
) -> TableData:
    """How far apart the two ways are, where, and how precise the blend is."""
    rms, largest = _along_flight(picture, whole, scan)
    percent = _percent(_range(whole))
    degrees = np.degrees(view_angles_rad)
    worst, worst_rms = int(np.argmax(largest)), int(np.argmax(rms))
    scale = float(rms.max())
    total = scale * math.sqrt(float(np.mean((rms / scale) ** 2))) if scale > 0.0 else 0.0
    rows = (
        ("rms_percent", total * percent, "%", "rms difference, of the picture's range"),
        ("max_percent", float(largest[worst]) * percent, "%", "largest difference, of the range"),
        ("max_view_deg", float(degrees[worst]), "deg", "view angle of the largest difference"),
        ("rms_worst_percent", scale * percent, "%", "rms at the view angle where it is largest"),
        ("rms_worst_view_deg", float(degrees[worst_rms]), "deg", "that view angle"),
        ("rms_difference", total, unit, "line by line less whole image"),
        ("max_difference", float(largest[worst]), unit, "largest modulus of it"),
        ("view_first_deg", float(degrees[0]), "deg", "view angle of the first sample of a line"),
        ("view_last_deg", float(degrees[-1]), "deg", "view angle of the last"),
        ("interval_nadir_mrad", max(intervals_mrad), "mrad", "in flight, nearest nadir"),
        ("interval_edge_mrad", min(intervals_mrad), "mrad", "in flight, farthest from nadir"),
        ("scale_nodes", filtered.nodes, "", "intervals at which planar factors were taken"),
        ("response_error", filtered.response_error, "", "of the transfer function, by blending"),
        ("error_percent", filtered.picture_error * percent, "%", "estimated error of the blend"),
    )
    return TableData(tuple(TableRow(*row) for row in rows))


def _along_flight(picture: Array, whole: Array, scan: Scan) -> tuple[Array, Array]:
    """Rms and largest modulus of the difference at each sample of a scan line."""
    axis = 0 if scan == "x" else 1
    gap = np.abs(np.subtract(picture, whole, dtype=np.float64))
    largest = gap.max(axis=axis)
    scale = float(largest.max())
    if scale == 0.0:
        return largest, largest
    # Relative to the largest: squares of huge or tiny differences leave the range of numbers.
    gap /= scale
    return scale * np.sqrt(np.mean(np.square(gap, out=gap), axis=axis)), largest


def _range(picture: Array) -> float:
    return float(picture.max()) - float(picture.min())


def _percent(span: float) -> float:
    """What a difference is multiplied by; a uniform picture has no range to compare with."""
    return 100.0 / span if span > 0.0 else 0.0
