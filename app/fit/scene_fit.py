"""Free parameters fitted to a whole picture of a known scene: the network's own source stays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from app.fit.chain_fit import ChainFit, Misfit, end_of, positive, scales_of
from app.fit.chain_transfer import ChainAt, final_image
from app.fit.fit_result import FitResult, result_of
from app.fit.free_parameter import FreeParameter
from app.fit.parameter_search import middle_of, places
from app.fit.scene_match import OWN, Registration, SceneFit, SceneMatch
from app.run.transfer_chain import find_chain
from core.chain.engine import Engine, Plan
from core.chain.realize import realize
from core.chain.step_lineage import source_step
from core.chain.wires import Image
from core.errors import Cancelled, DataError, ImagechainError
from core.evaluation.recipes import Step, ends_lineage
from core.evaluation.work import Work
from nodes.analysis.lineage import noise_free

Matrix = NDArray[np.float64]
Vector = NDArray[np.float64]

_STEP = 2e-3  # of a parameter's scale, for differences
_STEPS, _SETTLED = 30, 1e-4  # of the sum of squares, relative to noise
_WEIGHTINGS = 2  # times that the noise of what is left gives new weights
_MOVE = 0.02  # samples, for derivatives by place
_COARSE = 2  # of the places of a parameter, every so many is looked at first


_IN_PLACE = Registration()


class SceneProblem:
    def __init__(
        self, chain: ChainAt, work: Work, free: Sequence[FreeParameter], picture: Matrix
    ) -> None:
        self.free = tuple(free)
        self.match = SceneMatch(picture)
        self.evaluations = 0
        self._chain, self._work = chain, work
        self._held: dict[tuple[float, ...], Matrix] = {}
        plan = chain.plan([middle_of(parameter) for parameter in free])
        self._source = fine_source(
            chain.engine, plan, sources=find_chain(plan).sources, final=final_image(plan)
        )

    @property
    def why_after(self) -> str:
        """Why the sampled picture is moved though its source is finer; empty where it is not."""
        return self._source if isinstance(self._source, str) else ""

    def simulated(self, values: Vector, how: Registration = _IN_PLACE) -> Matrix:
        """The network's picture without noise, of its scene in its place, or moved and scaled."""
        source = self._source
        moved = isinstance(source, FineSource) and how.place != _IN_PLACE.place
        key = (*map(float, values), *(how.place if moved else _IN_PLACE.place))
        made = self._held.get(key)
        if made is None:
            self.evaluations += 1
            plan = self._chain.plan([float(value) for value in values])
            if isinstance(source, FineSource) and moved:
                plan = source.moved(plan, how)
            image = final_image(plan)
            shape = self.match.picture.shape
            if image.shape != shape:
                raise DataError(
                    f"the picture has {shape[1]} × {shape[0]} samples, but the "
                    f"network's final picture {image.columns} × {image.rows}"
                )
            clean = image.with_recipe(noise_free(image.recipe))
            made = np.asarray(realize(clean, self._work), np.float64)
            if len(self._held) >= 2 * len(key) + 2:
                self._held.clear()
            self._held[key] = made
        return made

    def registered(self, values: Vector, how: Registration) -> Matrix:
        """The network's picture where the real one has it, gain and offset included."""
        if isinstance(self._source, FineSource):
            return how.gain * self.simulated(values, how) + how.offset
        return self.match.registered(self.simulated(values), how)

    def residual(self, values: Vector, how: Registration) -> Vector:
        return self.match.waves(self.match.picture - self.registered(values, how))

    def own_columns(self, values: Vector, how: Registration) -> list[Vector]:
        if not isinstance(self._source, FineSource):
            return self.match.columns(self.simulated(values), how)
        here = self.simulated(values, how)
        made = []
        for place, step in enumerate((_MOVE, _MOVE, 2.0 * _MOVE / max(here.shape))):
            other = how.moved(np.eye(OWN)[place] * step)
            change = how.gain * (self.simulated(values, other) - here) / step
            made.append(self.match.waves(change))
        return [*made, self.match.waves(here), self.match.waves(np.ones_like(here))]

    def columns(self, values: Vector, how: Registration) -> list[Vector]:
        """Derivatives of the registered waves, by the parameters within their ranges."""
        made = []
        here = self.registered(values, how)
        scales = scales_of(self.free, values)
        for index, parameter in enumerate(self.free):
            step = _STEP * float(scales[index])
            other = values.copy()
            other[index] += step if values[index] + step <= parameter.high else -step
            there = self.registered(other, how)
            made.append(self.match.waves(there - here) / (other[index] - values[index]))
        return made


def fit_scene(problem: SceneProblem, start: Vector) -> FitResult:
    how = problem.match.coarse(problem.simulated(start))
    how = _settled_registration(problem, start, how)
    values = _looked_around(problem, start, how)
    values, how, residual = _downhill(problem, values, how)
    for _ in range(_WEIGHTINGS):
        left = problem.match.picture - problem.registered(values, how)
        problem.match = problem.match.reweighted(left)
        values, how, residual = _downhill(problem, values, how)

    def cost(other: Vector) -> float:
        try:
            settled = _settled_registration(problem, other, how)
            left = problem.residual(other, settled)
        except Cancelled:
            raise
        except ImagechainError:
            return math.inf
        return float(left @ left)

    values, unsigned = positive(problem.free, cost, values)
    residual = problem.residual(values, how)
    registered = problem.registered(values, how)
    problem.match.check_same_scene(problem.match.picture - registered, how)
    scene = problem.own_columns(values, how)
    own, _ = np.linalg.qr(np.column_stack(scene))
    jacobian = np.column_stack(problem.columns(values, how))
    jacobian -= own @ (own.T @ jacobian)
    chi2 = float(residual @ residual)
    degrees = int(problem.match.samples) - len(values) - OWN
    low, count = problem.match.low_waves(residual)
    misfit = Misfit(chi2, degrees, low, count - len(values) - OWN)
    jacobian /= math.sqrt(misfit.excess)
    scales = scales_of(problem.free, values)
    fit = ChainFit(
        problem.free, values, -jacobian, (), None, None, misfit,
        tuple(
            end_of(p, float(v), float(s))
            for p, v, s in zip(problem.free, values, scales, strict=True)
        ),
        problem.evaluations, unsigned,
    )  # fmt: skip

    result = result_of(fit, cost)
    note = (
        f"registered with a shift of {how.shift_x:.3f}, {how.shift_y:.3f} samples, a scale of "
        f"{how.scale:.6f}, a gain of {how.gain:.6g} and an offset of {how.offset:.6g}"
    )
    whole = SceneFit(problem.match.picture, registered, problem.match.noise_sigma)
    warnings = result.warnings
    if problem.why_after:
        warnings = (
            *warnings,
            f"{problem.why_after}, so its picture is shifted after sampling: the values are "
            "wrong by more than their errors unless the real picture is in register with it "
            "or has no aliasing",
        )
    return replace(result, notes=(*result.notes, note), warnings=warnings, scene=whole)


def _settled_registration(problem: SceneProblem, values: Vector, how: Registration) -> Registration:
    for _ in range(_STEPS):
        residual = problem.residual(values, how)
        columns = np.column_stack(problem.own_columns(values, how))
        step = _solved(columns, residual, 0.0)
        how = how.moved(step)
        gained = float((columns @ step) @ (columns @ step))
        if gained < 1e-3:
            break
    return how


def _looked_around(problem: SceneProblem, start: Vector, how: Registration) -> Vector:
    """Each parameter in turn at the best of its places, gain and offset fitted."""
    best = start.copy()

    def cost(values: Vector) -> float:
        try:
            made = problem.registered(values, replace(how, gain=1.0))
        except Cancelled:
            raise
        except ImagechainError:
            return math.inf
        columns = np.column_stack(
            [problem.match.waves(made), problem.match.waves(np.ones_like(made))]
        )
        real = problem.match.waves(problem.match.picture)
        left = real - columns @ _solved(columns, real, 0.0)
        return float(left @ left)

    least = cost(best)
    for index, parameter in enumerate(problem.free):
        for place in places(parameter)[::_COARSE]:
            other = best.copy()
            other[index] = place
            seen = cost(other)
            if seen < least:
                best, least = other, seen
    return best


def _downhill(
    problem: SceneProblem, values: Vector, how: Registration
) -> tuple[Vector, Registration, Vector]:
    """Levenberg and Marquardt's way, parameters and registration together, within the ranges."""
    lows = np.array([parameter.low for parameter in problem.free])
    highs = np.array([parameter.high for parameter in problem.free])
    count, damping = len(values), 1e-3
    residual = problem.residual(values, how)
    cost = float(residual @ residual)
    for _ in range(_STEPS):
        columns = np.column_stack(
            [*problem.columns(values, how), *problem.own_columns(values, how)]
        )
        improved = False
        for _ in range(8):
            step = _solved(columns, residual, damping)
            other = np.clip(values + step[:count], lows, highs)
            moved = how.moved(step[count:])
            try:
                left = problem.residual(other, moved)
                seen = float(left @ left)
            except Cancelled:
                raise
            except ImagechainError:
                seen = math.inf
            if seen < cost:
                improved = True
                break
            damping = max(damping, 1e-6) * 8.0
        if not improved:
            break
        gained = cost - seen
        values, how, residual, cost, damping = other, moved, left, seen, damping / 8.0
        if gained < _SETTLED * max(1.0, cost / problem.match.samples):
            break
    return values, how, residual


def _solved(columns: Matrix, residual: Vector, damping: float) -> Vector:
    """The step that takes the residual down, each column scaled to length 1 and damped."""
    length = np.linalg.norm(columns, axis=0) + 1e-300
    scaled = columns / length
    matrix = scaled.T @ scaled
    matrix[np.diag_indices_from(matrix)] += damping + 1e-12
    solution: Vector = np.linalg.solve(matrix, scaled.T @ residual) / length
    return solution


# A network's scene moved and scaled before anything of the chain has blurred or sampled it.
#
# A picture that was sampled cannot be moved by a part of a sample: what has folded below the
# Nyquist frequency would turn with it the wrong way. So where the chain samples more coarsely than
# its source, the source is moved, between its fine samples by splines of the fifth order (Unser
# 1999).

_ORDER = 5
_OUTSIDE = "reflect"  # as the frame goes on in the chain


@ends_lineage
def spline_factors(work: Work, scene: NDArray[np.floating]) -> Matrix:  # noqa: ARG001
    from scipy import ndimage

    values = np.asarray(scene, np.float64)
    return np.asarray(ndimage.spline_filter(values, _ORDER, mode=_OUTSIDE), np.float64)


@source_step(area_means=True)
def moved_scene(
    work: Work, factors: Matrix, *, shift_x: float, shift_y: float, scale: float
) -> NDArray[np.floating]:
    """The scene moved right and down by so many of its samples, and scaled about its middle."""
    from scipy import ndimage

    middle = (np.array(factors.shape) - 1.0) / 2.0
    start = middle - (middle + np.array([shift_y, shift_x])) / scale
    moved = ndimage.affine_transform(
        factors, np.full(2, 1.0 / scale), start, order=_ORDER, mode=_OUTSIDE, prefilter=False
    )
    return np.asarray(moved, work.policy.dtype)


@dataclass(frozen=True)
class FineSource:
    """The source of a network whose final picture has fewer samples."""

    engine: Engine  # plans the network
    port: str  # ``NODE.PORT`` of the source
    ratio: tuple[float, float]  # its samples for one of the final picture, across and down

    def moved(self, plan: Plan, how: Registration) -> Plan:
        node, _, output = self.port.rpartition(".")
        scene: Image = plan.output(self.port)
        recipe = Step.of(
            moved_scene,
            Step.of(spline_factors, scene.recipe, node=node),
            node=node,
            shift_x=how.shift_x * self.ratio[0],
            shift_y=how.shift_y * self.ratio[1],
            scale=how.scale,
        )
        source = plan.node(node)
        held = replace(source, outputs={**source.outputs, output: scene.with_recipe(recipe)})
        return self.engine.plan(plan.network, folder=plan.folder, previous=plan, held={node: held})


def fine_source(
    engine: Engine, plan: Plan, *, sources: Sequence[str], final: Image
) -> FineSource | str | None:
    """The source that is to be moved; None where the final picture can be moved just as well.

    Where there is a finer source that cannot be moved, why not, in words.
    """
    images = [plan.output(port) for port in sources]
    if all(image.shape == final.shape for image in images):
        return None
    if len(images) != 1:
        return f"the network has {len(images)} source pictures"
    if images[0].bands is not None:
        return f"{sources[0]} has wavelength bands"
    rows, columns = images[0].shape
    ratio = columns / final.columns, rows / final.rows
    return FineSource(engine, sources[0], ratio)
