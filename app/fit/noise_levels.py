"""Noise of a network's final picture at given levels: the network on small uniform fields.

The radiance at which the final picture has a level is sought; its noise there is the chain's.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from app.fit.chain_transfer import final_image
from app.run.transfer_chain import find_chain
from core.chain.engine import Engine, Plan, PlannedNode
from core.chain.step_lineage import source_step
from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import Step
from core.evaluation.work import Work
from core.physics.measurement.sample_noise import LevelVariance
from nodes.analysis.lineage import ImageNoise, NoiseOf

Vector = NDArray[np.float64]

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
            raise DataError(f"{self._port} has wavelength bands, but a uniform field has none")
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
            "the picture's noise at that level is unknown"
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
