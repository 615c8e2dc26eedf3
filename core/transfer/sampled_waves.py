"""The waves of a frame at places between its samples: band-limited interpolation, exactly.

A mirrored frame is a sum of cosines, and behind an odd filter of sines too; a periodic one a sum of
complex waves, at Nyquist a cosine alone. Their values at any places are known, so that a matrix for
each axis takes the place of the inverse transform: as exact as that, for any ratio of the samples.
It takes samples × places multiplications a line.
"""

import numpy as np

from core.arrays import Array, Vector
from core.evaluation.float_guard import require_finite
from core.evaluation.work import Work
from core.transfer.factors import Edges, Grid, Product
from core.transfer.mirrored import MeanFree, MirroredTerms
from core.transfer.periodic import PeriodicResponse

_BLOCK_SAMPLES = 1 << 18


def mirrored_waves(size: int, places: Vector, *, odd: bool) -> Array:
    """Cosines k = 0 … size − 1 of the inverse DCT-II at places, or sines of the inverse DST-II.

    Places count in samples from the middle of the first one; shape (size, places). Sine 0 is 0.
    """
    angle = np.outer(np.arange(size), (places + 0.5) / size) * np.pi
    waves = (np.sin(angle) if odd else np.cos(angle)) / size
    waves[0] *= 0.5
    return np.asarray(waves)


def periodic_waves(size: int, places: Vector, *, half: bool) -> Array:
    """Waves of the inverse FFT at places, as for `mirrored_waves`.

    `half`: those of the half spectrum, of which the real part is taken afterwards.
    """
    number = np.arange(size)
    number = number[: size // 2 + 1] if half else np.where(2 * number > size, number - size, number)
    angle = np.outer(number, places / size) * (2.0 * np.pi)
    waves = np.exp(1j * angle) / size
    nyquist = 2 * np.abs(number) == size
    waves[nyquist] = waves[nyquist].real
    if half:
        waves[(number > 0) & ~nyquist] *= 2.0
    return np.asarray(waves)


def sampled_columns(samples: Array, places: Vector, edges: Edges) -> Array:
    """Columns of samples at places between them; the frame goes on mirrored or periodic."""
    size = len(samples)
    if edges == "reflect":
        whole = np.concatenate([samples, samples[::-1]])
        twice = periodic_waves(2 * size, places, half=False)
    else:
        whole, twice = samples, periodic_waves(size, places, half=False)
    made = twice.T @ np.fft.fft(whole, axis=0)
    return np.asarray(made if np.iscomplexobj(samples) else made.real)


def sampled_filter(
    work: Work,
    spectrum: MeanFree,
    product: Product,
    grid: Grid,
    edges: Edges,
    places_x: Vector,
    places_y: Vector,
) -> Array:
    """The filtered frame at columns and rows between its samples, from the first one's middle."""
    made = _mirrored if edges == "reflect" else _periodic
    image = made(work, spectrum.values, product, grid, places_x, places_y)
    require_finite(image)
    image += np.asarray(spectrum.mean * product.at_zero(work), image.dtype)
    return image


def _mirrored(
    work: Work, spectrum: Array, product: Product, grid: Grid, places_x: Vector, places_y: Vector
) -> Array:
    terms = MirroredTerms(work, product, grid)
    kind = spectrum.dtype
    across = {
        odd: mirrored_waves(grid.columns, places_x, odd=odd).astype(kind) for odd in terms.odd_x
    }
    total = np.zeros((len(places_y), len(places_x)), kind)
    height = max(1, _BLOCK_SAMPLES // grid.columns)
    for odd_y in terms.odd_y:
        lines = np.zeros((grid.rows, len(places_x)), kind)

        def one(start: int, odd_y: bool = odd_y, lines: Array = lines) -> None:
            stop = min(start + height, grid.rows)
            for odd_x, values in terms.apply(spectrum, start, stop, odd_y):
                lines[start:stop] += values @ across[odd_x]

        work.for_each(one, range(0, grid.rows, height))
        along = mirrored_waves(grid.rows, places_y, odd=odd_y).astype(kind)
        if odd_y:
            along, lines = along[1:], lines[:-1]  # sine k stands at index k − 1
        total += along.T @ lines
    return total


def _periodic(
    work: Work, spectrum: Array, product: Product, grid: Grid, places_x: Vector, places_y: Vector
) -> Array:
    response = PeriodicResponse(work, product, grid)
    kind = spectrum.dtype
    across = periodic_waves(grid.columns, places_x, half=True).astype(kind)
    lines = np.empty((grid.rows, len(places_x)), kind)
    height = max(1, _BLOCK_SAMPLES // grid.columns)

    def one(start: int) -> None:
        rows = slice(start, min(start + height, grid.rows))
        lines[rows] = response.apply(spectrum[rows], rows) @ across

    work.for_each(one, range(0, grid.rows, height))
    along = periodic_waves(grid.rows, places_y, half=False).astype(kind)
    return np.ascontiguousarray((along.T @ lines).real)
