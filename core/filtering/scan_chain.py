"""A chain's transfer function as a line scanner meets it: along the scan, in flight, and both."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.evaluation.work import Work
from core.transfer.grid import Edges, Grid
from core.transfer.planar_blocks import Axes, Planes
from core.transfer.product import Product

Array = NDArray[Any]
Vector = NDArray[np.float64]


@dataclass(frozen=True)
class ScanChain:
    """H(scan, flight), whichever axis of the frame the scan is along.

    Parameters
    ----------
    product : Product
        The transfer function of (xi, eta).
    grid : Grid
        Sampling of the frame.
    edges : "reflect" or "periodic"
        How the frame goes on beyond its edges.
    scan : "x" or "y"
        Axis along which a line is scanned.
    """

    product: Product
    grid: Grid
    edges: Edges
    scan: str = "x"

    @property
    def turned(self) -> bool:
        """Whether frames have to be transposed for their lines to be rows."""
        return self.scan == "y"

    @property
    def shape(self) -> tuple[int, int]:
        """Scan lines, and samples of each."""
        rows, columns = self.grid.shape
        return (columns, rows) if self.turned else (rows, columns)

    @property
    def interval_mrad(self) -> float:
        """Sampling interval along the scan."""
        return self.grid.interval_y_mrad if self.turned else self.grid.interval_x_mrad

    def along_scan(self, work: Work, frequency: Array) -> Array:
        """What separates and acts along the scan."""
        axis = self.product.along if self.turned else self.product.across
        return axis(work, frequency)

    def in_flight(self, work: Work, frequency: Array) -> Array:
        """What separates and acts in flight."""
        axis = self.product.across if self.turned else self.product.along
        return axis(work, frequency)

    def plane(self, work: Work, scan: Array, flight: Array) -> Array:
        """What does not separate, for scan (columns,) × flight (rows,)."""
        if not self.turned:
            plane = self.product.plane(work, scan, flight)
        else:
            plane = self.product.plane(work, flight, scan)
            plane = None if plane is None else plane.T
        assert plane is not None, "called only where there are planar factors"
        return np.broadcast_to(plane, (len(flight), len(scan)))

    def stored_plane(self, work: Work, interval_mrad: float) -> Array:
        """Symmetric planar factors at one interval in flight, as stored.

        For mirrored frames (flight, scan), neither frequency negative. For periodic ones flight
        from 0 to Nyquist, and scan in FFT order.
        """
        axes: Axes = "mirrored" if self.edges == "reflect" else "periodic"
        if self.turned:
            grid = replace(self.grid, interval_x_mrad=interval_mrad)
        else:
            grid = replace(self.grid, interval_y_mrad=interval_mrad)
        plane = Planes(work, self.product, grid, axes).block(slice(0, self.grid.rows))
        assert plane is not None, "called only where there are planar factors"
        if self.turned:
            return np.ascontiguousarray(plane.T)
        if self.edges == "reflect":
            return plane
        place = np.arange(self.grid.columns)
        half = np.minimum(place, self.grid.columns - place)
        return np.ascontiguousarray(plane[: self.grid.rows // 2 + 1][:, half])
