"""What a network does to an ideal edge: its complex transfer function along the edge's normal.

The edge takes the place of the source, and no samples blur it. Where pixels are combined
from the source's samples, or nothing averages over an area, the samples' area is the pixel's.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.fit.edge_fit import HIGHEST, SpreadTable, frequencies, spread_table
from app.run.transfer_chain import HOW_TO_MARK, HOW_TO_NAME, find_chain, find_output
from core import kernels
from core.chain.engine import Engine, Plan, PlannedNode
from core.chain.step_lineage import PlaceDependent, lineage_of, source_step
from core.chain.wires import Image
from core.errors import DataError, UsageError
from core.evaluation.recipes import Step
from core.evaluation.work import Work
from core.physics.detector.detector_mtf import aperture_mtf
from core.physics.measurement.sample_noise import LevelVariance
from core.physics.numerics import sinc
from core.physics.sampling.detector_sampling import block_mean_mtf
from core.records import replace
from core.transfer.factors import Factor, Planar, Separable
from nodes.analysis.lineage import ImageNoise, ImageTransfer, NoiseOf, transfer_of

Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]

_BLOCKS = ((0, 1), (1, 2), (2, 4), (4, 8), (8, HIGHEST))  # cycles per sample
_NOTHING = 1e-6  # of an edge's step: waves that carry less are left out
_REPETITIONS = (-1, 0, 1)
_MOST_VALUES = 400  # factors over a block of frequencies that are held


def final_image(plan: Plan) -> Image:
    output = find_output(plan)
    if output.port is None:
        if not output.choices:
            raise UsageError(output.missing)
        raise UsageError(f"{output.missing}: {HOW_TO_MARK}", hint=HOW_TO_NAME)
    image = plan.output(output.port)
    assert isinstance(image, Image)
    return image


def transfer_known(image: Image) -> ImageTransfer:
    passed = transfer_of(image)
    source = passed.source
    if lineage_of(source) is None:
        raise DataError(
            f"{source.node or 'a node'} has no known transfer function, so an edge cannot be "
            "traced through it. Mark a picture before this node as the output, or disable the node",
            hint=HOW_TO_NAME,
        )
    return passed


def has_area(passed: ImageTransfer) -> bool:
    """Whether the area of the source's samples is the pixel's."""
    functions = {law.function for factor in passed.factors for law in factor.laws}
    return passed.area_means and (block_mean_mtf in functions or aperture_mtf not in functions)


class EdgeTransfer:
    """Spreads of edges behind a chain; what did not change since is not computed again."""

    def __init__(self, work: Work, angles_deg: Sequence[float], period: int) -> None:
        self._work = work
        self._period = period
        angle = np.radians(np.asarray(angles_deg, np.float64))[:, np.newaxis]
        self._normal = np.cos(angle), np.sin(angle)
        self._held: dict[tuple[Any, ...], Complex] = {}

    def table(self, image: Image) -> SpreadTable:
        passed = transfer_known(image)
        blocks = []
        for first, end in _BLOCKS:
            self._work.check()
            blocks.append(self._block(passed, first, end))
            left = float(np.abs(blocks[-1]).max())
            if first > 0 and left / (math.pi * first) < _NOTHING:
                break
        return spread_table(transfer=np.concatenate(blocks, axis=1), period=self._period)

    def point_spread(self, image: Image, *, reach: int) -> Vector:
        """What a point of weight 1 leaves in the samples about it, up to `reach` away.

        Of shape (2 reach + 1, 2 reach + 1), the point in the middle.
        """
        passed = transfer_known(image)
        grid = passed.grid
        side = 4 * reach
        total = np.zeros((side, side // 2 + 1), np.complex128)
        # Samples see waves of all repetitions of the spectrum.
        for across, down in itertools.product(_REPETITIONS, _REPETITIONS):
            xi = (np.fft.rfftfreq(side) + across) / grid.interval_x_mrad
            eta = (np.fft.fftfreq(side) + down) / grid.interval_y_mrad
            pair = np.broadcast_arrays(xi, eta[:, np.newaxis])
            total += self._product(passed, *pair, place=(side, across, down))
        spread = np.fft.fftshift(kernels.irfft2(total, (side, side)))
        return np.asarray(spread[reach : 3 * reach + 1, reach : 3 * reach + 1], np.float64)

    def _block(self, passed: ImageTransfer, first: int, end: int) -> Complex:
        f = frequencies(period=self._period, first=first, end=end)[np.newaxis, :]
        across, along = self._normal
        grid = passed.grid
        xi = f * across / grid.interval_x_mrad
        eta = f * along / grid.interval_y_mrad
        return self._product(passed, xi, eta, place=(first,))

    def _product(
        self, passed: ImageTransfer, xi: Vector, eta: Vector, *, place: tuple[int, ...]
    ) -> Complex:
        grid, scene = passed.grid, passed.source_grid
        total = np.ones(xi.shape, np.complex128)
        if has_area(passed):
            total = total * sinc(xi * scene.interval_x_mrad) * sinc(eta * scene.interval_y_mrad)
        for factor in passed.factors:
            key = (factor.key, grid.interval_x_mrad, grid.interval_y_mrad, *place)
            if (values := self._held.get(key)) is None:
                values = self._held[key] = _complex_at(self._work, factor, xi, eta)
                if len(self._held) > _MOST_VALUES:
                    del self._held[next(iter(self._held))]
            total = total * values
        return total


def _complex_at(work: Work, factor: Factor, xi: Vector, eta: Vector) -> Complex:
    if isinstance(factor, Planar):
        if factor.radial and _is_alike(xi, eta, factor.ratios):
            # One row stands for all: some laws take long.
            row = factor.transfer(work, xi[:1], eta[:1])
            return np.asarray(np.broadcast_to(row, xi.shape), np.complex128)
        return np.asarray(np.broadcast_to(factor.transfer(work, xi, eta), xi.shape), np.complex128)
    assert isinstance(factor, Separable)
    total: Any = np.ones(xi.shape) if factor.part == "mtf" else np.zeros(xi.shape)
    for law, frequency in ((factor.x, xi), (factor.y, eta)):
        if law is None:
            continue
        flat = frequency.ravel()
        if isinstance(factor, PlaceDependent):
            values = factor.mean_over(law, flat, 1.0)
        else:
            made = factor.axis(work, law, flat)
            assert made is not None
            values = made
        values = values.reshape(xi.shape)
        total = total * values if factor.part == "mtf" else total + values
    if factor.part == "ptf":
        total = np.exp(1j * total)
    return np.asarray(total, np.complex128)


def _is_alike(xi: Vector, eta: Vector, ratios: tuple[float, float]) -> bool:
    """Whether radial frequencies are the same in all rows."""
    last = np.hypot(xi[:, -1] * ratios[0], eta[:, -1] * ratios[1])
    return bool(np.ptp(last) <= 1e-12 * np.abs(last).max())


class ChainAt:
    """A network's final picture as its free parameters take other values."""

    def __init__(self, engine: Engine, plan: Plan, names: Sequence[tuple[str, str]]) -> None:
        self.engine = engine
        self._names = tuple(names)
        self._last = plan

    def plan(self, values: Sequence[float]) -> Plan:
        from app.tradeoff.tradeoff_results import with_value

        network = self._last.network
        for (node, name), value in zip(self._names, values, strict=True):
            if network.nodes[node].params.get(name) != float(value):
                network = with_value(network, self.engine, node, name, float(value))
        self._last = self.engine.plan(network, folder=self._last.folder, previous=self._last)
        return self._last

    def image(self, values: Sequence[float]) -> Image:
        return final_image(self.plan(values))


# Noise of a network's final picture at given levels: the network on small uniform fields.
#
# The radiance at which the final picture has a level is sought; its noise there is the chain's.

_SIDE = 16  # samples of a field
_POINTS = 3  # radiances between the darkest and the brightest level
_TRIALS = 12
_NEAR = 0.02  # of the level's distance from another, to which a radiance is sought


@source_step(area_means=True)
def uniform_field(work: Work, *, value: float, rows: int, columns: int) -> NDArray[np.floating]:
    """A field of one radiance, in the evaluation's precision."""
    return np.full((rows, columns), value, work.policy.dtype)


class NoiseLevels:
    def __init__(self, engine: Engine, plan: Plan, work: Work) -> None:
        self._engine, self._work = engine, work
        sources = find_chain(plan).sources
        if len(sources) != 1:
            raise DataError(
                f"the final picture comes from {len(sources)} source pictures, not from one"
            )
        self._port = sources[0]
        scene: Image = plan.output(self._port)
        if scene.bands is not None:
            raise DataError(
                f"{self._port} has wavelength bands, but noise can only be predicted without bands"
            )
        self._scene = scene
        values = work.value(scene.recipe)
        start = float(np.mean(values, dtype=np.float64)) or 1.0
        self._starts = [start, start]

    def at(self, plan: Plan, levels: Sequence[float]) -> Vector:
        """Variance of a sample at each level, random from sample to sample."""
        low, high = min(levels), max(levels)
        seen: dict[float, tuple[float, float]] = {}

        def field(radiance: float) -> tuple[float, float]:
            if radiance not in seen:
                seen[radiance] = self._field(plan, radiance)
            return seen[radiance]

        apart = max(high - low, 1e-3 * max(abs(low), abs(high)), 1e-12)
        first = self._radiance(field, low, apart, 0)
        last = self._radiance(field, high, apart, 1) if high > low else first
        for radiance in np.linspace(first, last, _POINTS) if last > first else ():
            field(float(radiance))
        pairs = np.array(sorted(seen.values()))
        mean, variance = pairs[:, 0], pairs[:, 1]
        inside = (mean >= low - apart) & (mean <= high + apart)
        if np.count_nonzero(inside) < _POINTS:
            return np.asarray(np.interp(levels, mean, variance), np.float64)
        # Shot noise is a line, a spread of gains a parabola over the level.
        middle, scale = 0.5 * (low + high), apart
        fit = np.polyfit((mean[inside] - middle) / scale, variance[inside], 2)
        return np.asarray(np.polyval(fit, (np.asarray(levels) - middle) / scale), np.float64)

    def _radiance(
        self, field: Callable[[float], tuple[float, float]], level: float, apart: float, end: int
    ) -> float:
        """Where the final picture's mean is a level, by the secant from where it was last."""
        one, other = self._starts[end], 0.9 * self._starts[end]
        for _ in range(_TRIALS):
            a = field(one)[0]
            if abs(a - level) < _NEAR * apart:
                self._starts[end] = one
                return one
            b = field(other)[0]
            if a == b:
                break
            one, other = one + (level - a) * (one - other) / (a - b), one
            if not math.isfinite(one) or one < 0.0:
                one = 0.5 * other
        raise DataError(
            f"no source radiance brings the network's final picture to a level of {level:.6g}, so "
            "the network's noise at that level cannot be predicted"
        )

    def _field(self, plan: Plan, radiance: float) -> tuple[float, float]:
        self._work.check()
        node, _, output = self._port.rpartition(".")
        recipe = Step.of(uniform_field, node=node, value=float(radiance), rows=_SIDE, columns=_SIDE)
        image = self._scene.with_recipe(recipe, rows=_SIDE, columns=_SIDE)
        source = plan.node(node)
        held: PlannedNode = replace(source, outputs={**source.outputs, output: image})
        small = self._engine.plan(plan.network, folder=plan.folder, held={node: held})
        noise: ImageNoise = self._work.value(NoiseOf(final_image(small), uniform=True))
        noise.require_known()
        total = noise.total
        return noise.mean, max(total.tvh, 0.0) + max(total.vh, 0.0)


class NoiseProblem:
    def __init__(self, levels: NoiseLevels, measured: Sequence[LevelVariance]) -> None:
        self._levels = levels
        self.measured = tuple(one for one in measured if one.variance > 0.0)
        self._places = [one.level for one in self.measured]
        variance = np.array([one.variance for one in self.measured])
        error = np.array([one.variance_error for one in self.measured])
        self._log = np.log(variance)
        self._error = np.maximum(error / variance, 1e-3)

    def predicted(self, plan: Plan) -> Vector:
        return self._levels.at(plan, self._places)

    def residual(self, plan: Plan) -> Vector:
        """Predicted less measured logarithms (variances begin orders apart), in standard errors."""
        predicted = np.maximum(self.predicted(plan), 1e-300)
        return np.asarray((np.log(predicted) - self._log) / self._error, np.float64)
