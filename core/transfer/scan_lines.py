"""Scan lines of a frame: spectra of its columns in flight, and filtering along the lines.

The frame is transformed, multiplied by what acts along the scan and by what does not separate, and
transformed back along the scan alone: P[j, c] is what column c has at the frequency j in flight,
for frequencies of that sign, and Q[j, c] for those of the other where it is not P again. Then the
factors in flight are applied, in each column at frequencies of its own, and P and Q become samples.
"""

from abc import ABC, abstractmethod
from typing import Any, Literal

import numpy as np
from numpy.typing import DTypeLike

from core import kernels
from core.arrays import Array, Vector
from core.errors import require_finite
from core.evaluation.work import Work
from core.physics.sampling.platform_motion import scale_nodes_mrad, scale_weights
from core.records import dataclass, replace
from core.transfer.factors import Edges, Grid, Product, Separable
from core.transfer.mirrored import BLOCK_SAMPLES, LEAST_COLUMNS
from core.transfer.periodic import fourier
from core.transfer.planar_blocks import Planes, thin_product

Parts = tuple[Array, ...]


class ScanLines(ABC):
    """The spectrum of a frame, whose lines are rows, multiplied by what acts along the scan.

    `dtype` is the real type of the samples in between.
    """

    scan: Array
    flight: Array  # cycles a sample

    def __init__(self, work: Work, chain: "ScanChain", frame: Array, dtype: DTypeLike) -> None:
        self.work, self.chain = work, chain
        self.real = np.dtype(dtype)
        self.mean = float(np.mean(frame, dtype=np.float64))
        self.planar = bool(chain.product.planar)
        self.symmetric = chain.product.symmetric
        self.columns = frame.shape[1]
        self.values = self._spectrum(np.subtract(frame, self.mean, dtype=self.real))
        self.values = self.values * self.narrow(self._along_scan())

    def narrow(self, values: Array) -> Array:
        """The same in the type of the samples in between, or the complex type of it."""
        kind = np.result_type(self.real, np.complex64) if np.iscomplexobj(values) else self.real
        return np.asarray(values, kind)

    @abstractmethod
    def _spectrum(self, frame: Array) -> Array:
        """Both transforms of the frame."""

    def _along_scan(self) -> Array:
        return self.chain.along_scan(self.work, self.scan)

    def with_planar(self, interval_mrad: float) -> Parts:
        """The spectrum times what does not separate, at one interval in flight: P, or P and Q."""
        if self.symmetric:
            return (self.values * self.chain.stored_plane(self.work, interval_mrad),)
        return self.evaluated(interval_mrad, slice(0, len(self.flight)))

    def evaluated(self, interval_mrad: float, rows: slice) -> Parts:
        """The same for some frequencies in flight, nothing taken from or left in the store."""
        values, flight = self.values[rows], self.flight[rows] / interval_mrad
        if self.symmetric:
            return (values * self.narrow(self.chain.plane(self.work, self.scan, flight)),)
        return tuple(values * self.narrow(self._plane(sign * flight)) for sign in (1.0, -1.0))

    def _plane(self, flight: Array) -> Array:
        return self.chain.plane(self.work, self.scan, flight)

    @property
    def kind(self) -> np.dtype[Any]:
        return np.dtype(np.result_type(self.real, np.complex64))

    @abstractmethod
    def unscanned(self, values: Array) -> Array:
        """All columns of a spectrum, by fast transforms along the scan."""

    @abstractmethod
    def summed(self, values: Array, columns: Array) -> Array:
        """Some columns of a spectrum, by a direct sum along the scan."""

    @abstractmethod
    def samples(self, parts: Parts, response: Array) -> Array:
        """Samples of columns from P, or P and Q, and their responses in flight."""


class MirroredLines(ScanLines):
    """A frame that is mirrored at its edges without end."""

    def __init__(self, work: Work, chain: "ScanChain", frame: Array, dtype: DTypeLike) -> None:
        rows, columns = frame.shape
        self.scan = np.arange(columns) / (2.0 * columns * chain.interval_mrad)
        self.flight = np.arange(rows) / (2.0 * rows)
        super().__init__(work, chain, frame, dtype)

    def _spectrum(self, frame: Array) -> Array:
        return np.asarray(kernels.dctn(frame, type=2, workers=self.work.policy.workers))

    @property
    def kind(self) -> np.dtype[Any]:
        """Of symmetric factors the real part is enough."""
        return self.real if self.symmetric else super().kind

    def unscanned(self, values: Array) -> Array:
        """Cosines by the inverse DCT-II, sines by the inverse DST-II, as in `mirrored`."""
        even = self._cosines(values.real, 1)
        if not np.iscomplexobj(values):
            return even if self.symmetric else even + 1j * self._sines(values.real, 1)
        even = even - self._sines(values.imag, 1)
        if self.symmetric:
            return even
        return even + 1j * (self._sines(values.real, 1) + self._cosines(values.imag, 1))

    def summed(self, values: Array, columns: Array) -> Array:
        """The waves are exp(iπk(c + 1/2)/n)."""
        size = self.columns
        steps = np.outer(np.arange(size), 2 * columns + 1) % (4 * size)
        angle = np.pi / (2 * size) * steps
        weight = np.where(np.arange(size) == 0, 0.5, 1.0)[:, np.newaxis] / size
        cosine, sine = weight * np.cos(angle), weight * np.sin(angle)
        if self.symmetric:
            even = values.real @ cosine
            return np.asarray(even - values.imag @ sine if np.iscomplexobj(values) else even)
        return np.asarray(values @ (cosine + 1j * sine))

    def samples(self, parts: Parts, response: Array) -> Array:
        """The mean of both signs in flight: its even part and, for phases, its odd part."""
        if len(parts) == 1:
            even, odd = response.real * parts[0], None
            if np.iscomplexobj(response):
                odd = response.imag * parts[0]
        else:
            up, down = response * parts[0], response.conj() * parts[1]
            even, odd = 0.5 * (up + down).real, 0.5 * (up - down).imag
        result = self._cosines(even, 0)
        return result if odd is None else result - self._sines(odd, 0)

    def _cosines(self, values: Array, axis: int) -> Array:
        workers = self.work.policy.workers if axis == 1 else 1
        return np.asarray(kernels.idct(values, type=2, axis=axis, workers=workers))

    def _sines(self, values: Array, axis: int) -> Array:
        workers = self.work.policy.workers if axis == 1 else 1
        moved = np.zeros_like(values)
        target, source = (slice(None, -1), slice(1, None))
        if axis == 0:
            moved[target] = values[source]
        else:
            moved[:, target] = values[:, source]
        return np.asarray(kernels.idst(moved, type=2, axis=axis, workers=workers))


class PeriodicLines(ScanLines):
    """A frame that repeats without end; at Nyquist the mean of both signs acts."""

    def __init__(self, work: Work, chain: "ScanChain", frame: Array, dtype: DTypeLike) -> None:
        rows, columns = frame.shape
        self.lines = rows
        self.scan = np.fft.fftfreq(columns, chain.interval_mrad)
        self.flight = np.fft.rfftfreq(rows)
        super().__init__(work, chain, frame, dtype)

    @property
    def _middle(self) -> int | None:
        return self.columns // 2 if self.columns % 2 == 0 else None

    def _spectrum(self, frame: Array) -> Array:
        workers = self.work.policy.workers
        half = kernels.rfft(frame, axis=0, workers=workers)
        return np.asarray(kernels.fft(half, axis=1, overwrite_x=True, workers=workers))

    def _along_scan(self) -> Array:
        response = self.chain.along_scan(self.work, self.scan)
        if self._middle is not None:
            # Of factors that are not symmetric `_plane` takes care.
            response[self._middle] = response[self._middle].real if self.symmetric else 1.0
        return response

    def _plane(self, flight: Array) -> Array:
        plane = np.array(super()._plane(flight), np.complex128)
        if self._middle is not None:
            nyquist = self.scan[self._middle :][:1]
            both = [
                self.chain.along_scan(self.work, end) * self.chain.plane(self.work, end, flight)
                for end in (nyquist, -nyquist)
            ]
            plane[:, self._middle] = 0.5 * (both[0] + both[1])[:, 0]
        return plane

    def unscanned(self, values: Array) -> Array:
        return np.asarray(kernels.ifft(values, axis=1, workers=self.work.policy.workers))

    def summed(self, values: Array, columns: Array) -> Array:
        """The waves are exp(2πikc/n)."""
        steps = np.outer(np.arange(self.columns), columns) % self.columns
        return np.asarray(values @ (np.exp(2j * np.pi / self.columns * steps) / self.columns))

    def samples(self, parts: Parts, response: Array) -> Array:
        """The half spectrum in flight, both signs at Nyquist."""
        total = response * parts[0]
        if self.lines % 2 == 0:
            total[-1] = 0.5 * (total[-1] + response[-1].conj() * parts[-1][-1])
        return np.asarray(kernels.irfft(total, n=self.lines, axis=0))


# A chain's transfer function as a line scanner meets it: along the scan, in flight, and both.


@dataclass(frozen=True)
class ScanChain:
    """H(scan, flight), whichever axis of the frame the scan is along."""

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
        rows, columns = self.grid.shape
        return (columns, rows) if self.turned else (rows, columns)

    @property
    def interval_mrad(self) -> float:
        return self.grid.interval_y_mrad if self.turned else self.grid.interval_x_mrad

    def along_scan(self, work: Work, frequency: Array) -> Array:
        axis = self.product.along if self.turned else self.product.across
        return axis(work, frequency)

    def in_flight(self, work: Work, frequency: Array) -> Array:
        axis = self.product.across if self.turned else self.product.along
        return axis(work, frequency)

    def plane(self, work: Work, scan: Array, flight: Array) -> Array:
        """What does not separate, for scan (columns,) × flight (rows,)."""
        if not self.turned:
            plane = self.product.plane(work, scan, flight)
        else:
            plane = self.product.plane(work, flight, scan)
            plane = None if plane is None else plane.T
        assert plane is not None, "the product has no planar factors"
        return np.broadcast_to(plane, (len(flight), len(scan)))

    def stored_plane(self, work: Work, interval_mrad: float) -> Array:
        """Symmetric planar factors at one interval in flight, as stored.

        For mirrored frames (flight, scan), neither frequency negative. For periodic ones flight
        from 0 to Nyquist, and scan in FFT order.
        """
        if self.turned:
            grid = replace(self.grid, interval_x_mrad=interval_mrad)
        else:
            grid = replace(self.grid, interval_y_mrad=interval_mrad)
        plane = Planes(work, self.product, grid, self.edges).block(slice(0, self.grid.rows))
        assert plane is not None, "the product has no planar factors"
        if self.turned:
            return np.ascontiguousarray(plane.T)
        if self.edges == "reflect":
            return plane
        place = np.arange(self.grid.columns)
        half = np.minimum(place, self.grid.columns - place)
        return np.ascontiguousarray(plane[: self.grid.rows // 2 + 1][:, half])


# Filtering along the scan lines (x) only: electronics that see one line after the other.

_BLOCK_SAMPLES = 1 << 16  # samples of a block of lines, to stay in a core's cache


def filter_lines(
    work: Work, image: Array, *, factors: tuple[Separable, ...], grid: Grid, edges: Edges
) -> Array:
    """Multiply each line's spectrum by the factors' x laws; their y laws must be empty.

    A line's mean passes by H(0), exactly where that is 1.
    """
    product = Product(factors)
    response = product.across(work, grid.axes(edges)[0])
    result = np.empty(image.shape, work.policy.dtype)
    height = max(1, _BLOCK_SAMPLES // image.shape[1])

    def one(start: int) -> None:
        lines = slice(start, min(start + height, image.shape[0]))
        mean = np.mean(image[lines], axis=1, keepdims=True, dtype=np.float64)
        values = np.subtract(image[lines], mean, dtype=result.dtype)
        filtered = (
            _mirrored_lines(values, response)
            if edges == "reflect"
            else _periodic_lines(values, response)
        )
        require_finite(filtered)
        np.add(filtered, (mean * response[0].real).astype(result.dtype), out=result[lines])

    work.for_each(one, range(0, image.shape[0], height))
    return result


def _mirrored_lines(values: Array, response: Array) -> Array:
    """Even part by the DCT-II, odd part, moved by one index, by the DST-II, as in `mirrored`."""
    spectrum = kernels.dct(values, type=2, axis=1, overwrite_x=True)
    real = spectrum * response.real.astype(spectrum.dtype)
    result = kernels.idct(real, type=2, axis=1, overwrite_x=True)
    if np.iscomplexobj(response):
        odd = np.zeros_like(spectrum)
        np.multiply(spectrum[:, 1:], -response.imag[1:].astype(spectrum.dtype), out=odd[:, :-1])
        result += kernels.idst(odd, type=2, axis=1, overwrite_x=True)
    return np.asarray(result)


def _periodic_lines(values: Array, response: Array) -> Array:
    size = values.shape[1]
    if size == 1:
        return values
    spectrum = fourier().rfft(values, axis=1, overwrite_x=True)
    if size % 2 == 0:
        response = response.copy()
        response[-1] = response[-1].real  # at Nyquist the Hermitian part acts
    spectrum *= response.astype(spectrum.dtype)
    return np.asarray(fourier().irfft(spectrum, n=size, axis=1, overwrite_x=True))


# Filtering a frame whose samples lie at other angles in flight in each of its columns.
#
# Each column becomes that of the whole frame filtered at the column's own interval in flight. What
# separates is exact at the cost of a whole frame: one transform along the scan serves all columns,
# and in flight each has its own response. What does not separate is either summed up anew for every
# interval, or blended from a few intervals between the smallest and the largest.

Method = Literal["nodes", "direct"]
MOST_NODES = 32
FREQUENCIES = 24  # along the scan and in flight, at which blended factors are tried
LAW_NODES = (4, 8, 12, 16, 24, 32)  # tried in turn


Filtered = tuple[Array, int, float, float]
"""A frame of mixed sampling; how many intervals were taken for what does not separate, 0 if there
is no such factor; the largest error of the transfer function by blending, of those looked at, and
that in the picture, were all columns as far from a node as the last."""


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
        parts: Parts = _summed(lines, intervals_mrad)
        gap: Parts = ()
        count, response_error = len(np.unique(intervals_mrad)), 0.0
    else:
        parts, count, gap, response_error = _blended(lines, intervals_mrad, nodes, tolerance)
    responses = _responses(lines, intervals_mrad)
    picture = _delivered(lines, parts, responses)
    error = float(np.max(np.abs(_delivered(lines, gap, responses)))) if gap else 0.0
    picture += np.asarray(lines.mean * chain.product.at_zero(work), picture.dtype)
    if chain.turned:
        picture = np.ascontiguousarray(picture.T)
    picture = picture.astype(work.policy.dtype, copy=False)
    return picture, count, response_error, error


Blend = tuple[Parts, int, Parts, float]
"""Columns' spectra in flight, from how many intervals they are made, what they lack at the smallest
interval, and the error of the transfer function."""


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
        return (lines.unscanned(lines.values),), 0, (), 0.0
    last = float(intervals_mrad.min())
    if last == float(intervals_mrad.max()):
        return tuple(lines.unscanned(part) for part in lines.with_planar(last)), 1, (), 0.0
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
    return tuple(parts), nodes, tuple(gap), error


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
