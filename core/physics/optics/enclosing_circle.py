"""The smallest circle round points, such as the samples of an aperture of unknown outline."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.errors import ParameterError

Circle = tuple[float, float, float]
FAINT = 0.01  # of the largest transmission: black as scanners and JPEG leave it, no aperture
_SLACK = 1e-9  # of the radius: points as far outside lie on the circle but for rounding


def support_circle(samples: ArrayLike) -> Circle:
    """Smallest circle round the centres of all samples above 1 % of the largest.

    Edges are known to about half a sample, which leaves the centre of a half disc's circle loose
    by several: where a circle about the array's centre is at most one sample larger, it is that.

    Parameters
    ----------
    samples : array_like, shape (rows, columns)
        Transmission of a pupil.

    Returns
    -------
    x, y, radius : float
        Its centre across and along, counted from the array's first sample, and its radius, all in
        samples. Half a sample is the least radius.

    Raises
    ------
    ParameterError
        If all samples are 0.

    Notes
    -----
    The disc on which Zernike polynomials are orthogonal is the one that just holds the aperture:
    Mahajan 1994, Zernike circle polynomials and optical aberrations of systems with circular
    pupils, Applied Optics 33, 8121. Of a disc, a ring or a half disc it is the outline's own
    circle, of a disc or a ring wherever it lies in the array.
    """
    transmission = np.asarray(samples)
    lit = transmission > FAINT * transmission.max(initial=0.0)
    rows = np.flatnonzero(lit.any(axis=1))
    if len(rows) == 0:
        raise ParameterError("samples", 0, "a pupil that is transparent somewhere")
    # Only the first and the last of a row can lie on the circle.
    first = np.argmax(lit[rows], axis=1)
    last = lit.shape[1] - 1 - np.argmax(lit[rows, ::-1], axis=1)
    points = np.column_stack([np.concatenate([first, last]), np.tile(rows, 2)]).astype(float)
    x, y, radius = smallest_circle(points)
    middle_y, middle_x = (lit.shape[0] - 1) / 2, (lit.shape[1] - 1) / 2
    about_middle = float(np.hypot(points[:, 0] - middle_x, points[:, 1] - middle_y).max())
    if about_middle <= radius + 1.0:
        x, y, radius = middle_x, middle_y, about_middle
    return x, y, max(radius, 0.5)


def smallest_circle(points: NDArray[np.float64]) -> Circle:
    """Smallest circle round points, shape (number, 2): centre x, y and radius.

    The farthest point outside joins the two or three that hold the circle, which grows each time.
    Source: Gaertner 1999, Fast and robust smallest enclosing balls, ESA'99, LNCS 1643, 325.
    """
    holding = points[:1]
    while True:
        x, y, radius = _held(holding)
        away = np.hypot(points[:, 0] - x, points[:, 1] - y)
        farthest = int(np.argmax(away))
        if away[farthest] <= radius + _SLACK * (1.0 + radius):
            return x, y, radius
        candidates = np.vstack([holding, points[farthest]])
        holding = _fewest(candidates)


def _fewest(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those of at most four points, the last among them, whose circle holds all, the smallest."""
    best, least = points, np.inf
    for count in (2, 3):
        for chosen in combinations(range(len(points)), count):
            x, y, radius = _held(points[list(chosen)])
            away = np.hypot(points[:, 0] - x, points[:, 1] - y).max()
            if away <= radius + _SLACK * (1.0 + radius) and radius < least:
                best, least = points[list(chosen)], radius
    return best


def _held(points: NDArray[np.float64]) -> Circle:
    """Circle through one to three points; of two, that of their distance."""
    if len(points) < 3:
        x, y = points.mean(axis=0)
        return float(x), float(y), float(np.hypot(*(points[0] - (x, y))))
    start, (b, c) = points[0], points[1:] - points[0]
    area = 2.0 * (b[0] * c[1] - b[1] * c[0])
    if area == 0.0:
        return float(start[0]), float(start[1]), -1.0  # on one line: no circle, and none needed
    bb, cc = b @ b, c @ c
    x = (c[1] * bb - b[1] * cc) / area
    y = (b[0] * cc - c[0] * bb) / area
    return float(start[0] + x), float(start[1] + y), float(np.hypot(x, y))
