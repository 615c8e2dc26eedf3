"""Many ellipses at once: a crown of leaves costs little more than a leaf."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt

from nodes.scenes.coverage import FloatArray, ellipse_coverage

BATCH_SAMPLES = 1 << 14


class Ellipses:
    """Ellipses with axes along x and y.

    Parameters
    ----------
    centre_x, centre_y, radius_x, radius_y : ndarray, shape (count,)
        Centres and half axes.
    """

    def __init__(
        self,
        centre_x: FloatArray,
        centre_y: FloatArray,
        radius_x: FloatArray,
        radius_y: FloatArray,
    ) -> None:
        self._shapes = np.array([centre_x, centre_y, radius_x, radius_y])
        self._low_x, self._high_x = centre_x - radius_x, centre_x + radius_x
        self._low_y, self._high_y = centre_y - radius_y, centre_y + radius_y

    @property
    def top(self) -> float:
        """Upper end of all."""
        return float(self._low_y.min())

    @property
    def low(self) -> float:
        """Lower end of all."""
        return float(self._high_y.max())

    def shares(
        self, x_edges: FloatArray, y_edges: FloatArray
    ) -> Iterator[tuple[int, tuple[slice, slice], FloatArray]]:
        """Share of the samples around each ellipse that it covers.

        Parameters
        ----------
        x_edges, y_edges : ndarray, shape (columns + 1,), (rows + 1,)
            Borders of the samples.

        Yields
        ------
        index, (rows, columns), ndarray
            Those that touch the samples, in order.
        """
        left, right = _spans(self._low_x, self._high_x, x_edges)
        top, low = _spans(self._low_y, self._high_y, y_edges)
        touching = np.flatnonzero((left < right) & (top < low))
        if not touching.size:
            return
        # All have frames of the largest's size, shifted inward at the picture's borders.
        wide, tall = (right - left)[touching].max(), (low - top)[touching].max()
        x_start = np.minimum(left, x_edges.size - 1 - wide)
        y_start = np.minimum(top, y_edges.size - 1 - tall)
        count = max(1, BATCH_SAMPLES // int(wide * tall))
        for begin in range(0, touching.size, count):
            batch = touching[begin : begin + count]
            centre_x, centre_y, radius_x, radius_y = self._shapes[:, batch]
            shares = ellipse_coverage(
                x_edges[x_start[batch, None] + np.arange(wide + 1)],
                y_edges[y_start[batch, None] + np.arange(tall + 1)],
                centre_x=centre_x,
                centre_y=centre_y,
                radius_x=radius_x,
                radius_y=radius_y,
            )
            for index, share in zip(batch.tolist(), shares, strict=True):
                x, y = x_start[index], y_start[index]
                columns, rows = slice(left[index], right[index]), slice(top[index], low[index])
                own = share[rows.start - y : rows.stop - y, columns.start - x : columns.stop - x]
                yield index, (rows, columns), own


def _spans(
    low: FloatArray, high: FloatArray, edges: FloatArray
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """First sample that each touches, and the one after the last."""
    last = edges.size - 1
    first = np.clip(np.searchsorted(edges, low, side="right") - 1, 0, last)
    return first, np.maximum(np.minimum(np.searchsorted(edges, high, side="left"), last), first)
