"""MTF from the mean of rows across an upright edge or line, as the thesis measured it."""

import numpy as np

from core import kernels
from core.arrays import Matrix, Vector
from core.errors import DataError, several
from core.physics.measurement.slanted_edge import Target, jackknife_error
from core.records import dataclass

LEAST_SAMPLES = 8
_GROUPS = 24
_LEAST_CONTRAST = 5.0  # times the standard error of a mean of rows


@dataclass(frozen=True)
class RowAverage:
    """MTF measured from the mean of rows."""

    frequency: Vector  # cycles per sample, from 0 to 1/2
    # modulus divided by its largest, and standard error
    mtf: Vector
    error: Vector
    clipped: Vector  # mean of the rows, with level ends
    # first and last sample between these
    left: int
    right: int
    # step, or height of the line, and standard deviation of a sample about its column's mean
    contrast: float
    noise: float


def row_average(
    *,
    picture: Matrix,
    target: Target = "edge",
    clip_left: int | None = None,
    clip_right: int | None = None,
) -> RowAverage:
    """Measure the MTF across an edge, or line, that runs upright down a picture.

    Parameters
    ----------
    picture : ndarray
        Samples, shape (rows, columns), finite, of a size near 1: squares are taken.
    target : {'edge', 'line'}
        Only of an edge the derivative is taken.
    clip_left, clip_right : int, optional
        First and last sample of the transition: the ends beyond are set to their mean. If not
        given, three times as far from the middle as where a tenth of the step is left.

    Returns
    -------
    RowAverage
        MTF at the frequencies of the transform, standard error by leaving out groups of rows.

    Raises
    ------
    DataError
        If the picture is too small, has no edge, or nothing is left between the clipped ends.

    Notes
    -----
    Source: Tantalo 1996, eqs. 5.67 to 5.70 and appendix B. The thesis' "line spread" is the edge
    spread, and its derivative the line spread. The difference of neighbours has a response of its
    own, sinc(f), 0.64 at Nyquist, that the thesis leaves in, and so does this; a slant of the edge
    blurs too.
    """
    rows, columns = picture.shape
    if columns < LEAST_SAMPLES:
        raise DataError(
            f"the region is too small: {several(columns, 'sample')} across the edge; needed: "
            f"at least {LEAST_SAMPLES}"
        )
    profile = np.mean(picture, axis=0)
    noise = float(np.sqrt(np.mean((picture - profile) ** 2)))
    left, right, contrast = _transition(profile, target)
    outer = max(2, columns // 8)
    # Of a single row nothing but its ends shows the noise.
    ends = max(float(np.std(profile[:outer])), float(np.std(profile[-outer:])))
    doubt = max(noise / np.sqrt(rows), ends / np.sqrt(outer))
    if not contrast > _LEAST_CONTRAST * doubt or contrast < 1e-9:
        raise DataError(
            f"no {target} found: the levels differ by {contrast:.3g} of the region's range, "
            f"and the mean of {rows} rows is uncertain by {doubt:.2g} of the range"
        )
    left = left if clip_left is None else clip_left
    right = right if clip_right is None else clip_right
    if not 0 <= left < right < columns:
        raise DataError(
            f"the edge cannot extend from sample {left} to {right}: the first sample must be "
            f"before the last, and both samples within 0 to {columns - 1}"
        )
    clipped = with_level_ends(profile=profile, left=left, right=right)
    mtf = profile_mtf(profile=clipped, target=target)
    frequency = np.asarray(np.fft.rfftfreq(columns - (target == "edge")), np.float64)
    groups = min(_GROUPS, rows)
    error = np.zeros_like(mtf)
    if groups > 1:
        group = np.arange(rows) % groups
        replicas = [
            with_level_ends(profile=picture[group != g].mean(axis=0), left=left, right=right)
            for g in range(groups)
        ]
        moduli = np.array([profile_mtf(profile=replica, target=target) for replica in replicas])
        error = jackknife_error(replicas=moduli)
    return RowAverage(frequency, mtf, error, clipped, left, right, contrast, noise)


def with_level_ends(*, profile: Vector, left: int, right: int) -> Vector:
    """The profile with the ends before `left` and after `right` set to their mean."""
    clipped = profile.copy()
    if left > 0:
        clipped[:left] = np.mean(profile[:left])
    if right + 1 < len(profile):
        clipped[right + 1 :] = np.mean(profile[right + 1 :])
    return clipped


def profile_mtf(*, profile: Vector, target: Target) -> Vector:
    """Modulus of the transform of a profile's derivative, divided by its largest.

    Of a line the background, a ramp between its ends, is taken off instead.
    """
    if target == "edge":
        spread = np.diff(profile)
    else:
        spread = profile - np.linspace(profile[0], profile[-1], len(profile))
    modulus = np.abs(kernels.rfft(spread))
    largest = float(modulus.max())
    if not largest > 0.0:
        raise DataError(f"no {target} found: the mean of the rows is constant")
    return np.asarray(modulus / largest, np.float64)


def _transition(profile: Vector, target: Target) -> tuple[int, int, float]:
    columns = len(profile)
    outer = max(2, columns // 8)
    start, end = float(np.mean(profile[:outer])), float(np.mean(profile[-outer:]))
    if target == "edge":
        share = (profile - start) / (end - start) if end != start else np.zeros(columns)
        within = np.flatnonzero((share > 0.1) & (share < 0.9))
        middle = int(np.argmax(np.abs(np.diff(profile))))
        contrast = abs(end - start)
    else:
        height = np.abs(profile - np.linspace(start, end, columns))
        middle, contrast = int(np.argmax(height)), float(height.max())
        within = np.flatnonzero(height > 0.1 * contrast)
    reach = 2.0 if len(within) == 0 else max(2.0, 1.5 * (within[-1] - within[0] + 1))
    return max(0, int(middle - reach)), min(columns - 1, int(middle + 1 + reach)), contrast
