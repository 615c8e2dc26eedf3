"""A chain's free parameters fitted to the samples of edges by weighted least squares.

Standard errors are those of the linearized model (Bates and Watts 1988, Nonlinear Regression
Analysis, section 2), or of the scatter between edges where residuals have the shape of an edge.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from app.fit import chain_transfer
from app.fit.edge_fit import MARGIN, EdgeFits, EdgesAt, Patch, SpreadTable, period_for, reaching_in
from app.tradeoff.tradeoff_results import PointEvaluator
from core.arrays import Matrix, Vector
from core.chain.engine import Engine, Plan
from core.chain.wires import Image
from core.errors import FAULTS, DataError
from core.evaluation.work import Work
from core.kernels import special
from core.records import dataclass

Watch = Callable[[tuple[Patch, ...], EdgesAt], None]

_THIN, _THIN_EDGES = 200, 8  # samples of an edge, and edges, while a start is sought
_STARTS, _FIRST, _LAST = 5, 10, 25  # starts; evaluations from each, and from the best
_BEST = 3  # starts that are followed to the end
_RIVAL, _RIVAL_THIN = 12.0, 40.0  # of the sum of squares, within which another solution counts
_SEED = 1996
_STEP = 1e-3  # of a parameter's scale, for differences
_FINE_STEP = 2e-3  # of the same, to both sides
_AT_END = 1e-3  # of the scale
_SAME = 1.0  # of the sum of squares
_MUCH = 1.3  # times a value, by which it is moved to see what it changes
_SHOWN = 1e-7  # of an edge's step, or of a standard error of noise
_NEAR, _PLACES = 8.0, 161  # samples, and places, at which spreads are compared
_OFF = 1e4  # standard errors
_ROUNDS, _SETTLED = 8, 0.01  # the sum of squares moves no parameter by a tenth of its error
_HELD = 64  # spreads and noises that are held


# How much of a picture a fit leaves beyond noise, and by how much that widens its errors.

_RARE = 6e-5  # probability of a sum of squares by noise alone, below which it is no noise
_LEAST_DEGREES = 8
_IN_GROUP = 16  # residuals of neighbouring distances that are averaged
_NEAREST = 3.0  # samples about an edge
_LEVELS = 4  # levels and slopes of an edge, that count among its groups
# A chain of the wrong form: its residuals are 2.2 times the noise, and some of the step. Scenes'
# own edges are ideal to some percent of a step, which differs between edges: their scatter shows
# it. What all edges share does not scatter, and from 5 % on it has moved values by as much as any
# blur here does; fewer than 3 edges have no scatter, and 1 % is what an MTF is to be right to.
_HOPELESS, _MATERIAL, _OTHER_FORM = 5.0, 0.01, 0.05
_FEWEST = 3  # edges, of which a scatter is taken


@dataclass(frozen=True)
class Misfit:
    chi2: float  # sum of the squared residuals in units of their noise, and degrees of freedom
    degrees: int
    shape_chi2: float  # the same of residuals averaged at equal distances from the edge
    shape_degrees: int
    noise_chi2: float = 0.0  # the same of the noise at the measured levels; part of the first two
    noise_degrees: int = 0
    material: float = 0.0  # left near the worst edge beyond noise, of its step
    edges: int = 0  # how many were fitted

    @property
    def chi2_per_degree(self) -> float:
        """1 where the residuals are noise."""
        return self.chi2 / max(1, self.degrees)

    @property
    def shape_per_degree(self) -> float:
        """1 where what is left of the edges has no shape."""
        return self.shape_chi2 / max(1, self.shape_degrees)

    @property
    def excess(self) -> float:
        """By which variances are widened for the edges: 1 unless there is a misfit."""
        edges = self.degrees - self.noise_degrees
        own = _excess((self.chi2 - self.noise_chi2) / max(1, edges), edges)
        return max(own, _excess(self.shape_per_degree, self.shape_degrees))

    @property
    def is_hopeless(self) -> bool:
        """Whether the edges are of another form than the chain can give, and no error is known."""
        most = _MATERIAL if self.edges < _FEWEST else _OTHER_FORM
        return self.excess > _HOPELESS and self.material > most

    @property
    def is_material(self) -> bool:
        """Whether more is left of a step than an error without a scatter allows for."""
        return self.excess > _HOPELESS and self.material > _MATERIAL

    @property
    def noise_excess(self) -> float:
        return _excess(self.noise_chi2 / max(1, self.noise_degrees), self.noise_degrees)


def misfit_of(edges: EdgesAt, noises: Vector, degrees: int, shared: tuple[int, int]) -> Misfit:
    """How much is left beyond noise, and how much of that has the shape of edges."""
    shape, groups, material = 0.0, 0, 0.0
    own = edges.own.shape[1] + _LEVELS
    for index, weight in enumerate(edges.weight):
        inside = weight > 0.0
        order = np.argsort(edges.distance[index][inside], kind="stable")
        ends = np.arange(0, len(order) - _IN_GROUP + 1, _IN_GROUP)
        if not len(ends):
            continue
        count = np.diff(np.append(ends, len(order)))
        total = np.add.reduceat(edges.residual[index][inside][order], ends)
        shape += float(np.sum(total**2 / count))
        groups += max(0, len(ends) - own)
        # What is left near the edge beyond its noise, of the step.
        away = np.add.reduceat(edges.distance[index][inside][order], ends) / count
        near = np.abs(away) < _NEAREST
        if np.any(near):
            noise = 1.0 / (weight[inside].mean() * abs(float(edges.step[index])) + 1e-300)
            left = (total[near] / count[near]) ** 2 - 1.0 / count[near]
            material = max(material, noise * math.sqrt(max(float(left.mean()), 0.0)))
    chi2 = edges.cost + float(noises @ noises)
    return Misfit(
        chi2, degrees, shape, groups - shared[0], float(noises @ noises),
        max(0, len(noises) - shared[1]), material, len(edges.weight),
    )  # fmt: skip


def _excess(per_degree: float, degrees: int) -> float:
    """What is left for each degree, where noise alone would hardly ever leave as much."""
    if degrees < _LEAST_DEGREES:
        return 1.0
    return per_degree if per_degree * degrees > float(special("chdtri")(degrees, _RARE)) else 1.0


@dataclass(frozen=True)
class ChainFit:
    free: tuple[chain_transfer.FreeParameter, ...]  # what was fitted
    values: Vector  # their values
    jacobian: Matrix  # of the residuals, (samples, parameters), over the root of their misfit
    patches: tuple[Patch, ...]  # the edges' samples
    edges: EdgesAt  # all as fitted
    table: SpreadTable  # their spreads
    misfit: Misfit  # how well it fits
    at_end: tuple[str, ...]  # ``low`` or ``high`` where a value is there, else empty
    unsigned: tuple[int, ...]  # places of the parameters whose sign changes nothing
    rivals: tuple[Vector, ...]  # values elsewhere that fit nearly as well
    shown: frozenset[int]  # places of the parameters that the edges show
    rests_on: tuple[float, ...]  # edges per error, where their scatter counts


class EdgeProblem:
    def __init__(
        self,
        engine: Engine,
        plan: Plan,
        work: Work,
        free: Sequence[chain_transfer.FreeParameter],
        patches: Sequence[Patch],
        noise: chain_transfer.NoiseProblem | None = None,
    ) -> None:
        self.free = tuple(free)
        self.noise = noise
        self.patches = tuple(patches)
        self._engine, self._base, self._work = engine, plan, work
        self._at = PointEvaluator(engine, plan, [one.target for one in self.free], ())
        period = period_for(reach=max(patch.reach for patch in patches))
        angles = [patch.edge.angle_deg for patch in patches]
        self._transfer = chain_transfer.EdgeTransfer(work, angles, period)
        self._fits = EdgeFits(self.patches)
        self._last: tuple[Vector, SpreadTable, EdgesAt] | None = None
        self.watch: Watch | None = None
        every = frozenset(range(len(self.free)))
        self.shown, self.noisy = every, every if noise is not None else frozenset()
        self._tables: dict[tuple[float, ...], SpreadTable] = {}
        self._noises: dict[tuple[float, ...], Vector] = {}

    def plan(self, values: Vector) -> Plan:
        return self._at.planned([float(value) for value in values])

    def _image(self, values: Vector) -> Image:
        return chain_transfer.final_image(self.plan(values))

    def sort_out(self, values: Vector) -> None:
        """See which parameters the edges show, and which the noise; none counts for the other."""
        distance = np.tile(np.linspace(-_NEAR, _NEAR, _PLACES), (len(self.patches), 1))
        before, _ = self.table(values).at_all(distance)
        noise = self.noise_residual(values)
        shown, noisy = set(), set()
        for index, parameter in enumerate(self.free):
            for other in (
                _MUCH * values[index],
                values[index] / _MUCH,
                *chain_transfer.inner(parameter),
            ):
                changed = values.copy()
                changed[index] = other
                if not parameter.low <= other <= parameter.high or other == values[index]:
                    continue
                try:
                    # At the same distances: how fine a table is depends on the chain's band.
                    spread, _ = self.table(changed).at_all(distance)
                    if float(np.abs(spread - before).max()) > _SHOWN:
                        shown.add(index)
                    louder = np.abs(self.noise_residual(changed) - noise)
                    if float(louder.max(initial=0.0)) > _SHOWN:
                        noisy.add(index)
                except FAULTS:
                    continue
        self.shown, self.noisy = frozenset(shown), frozenset(noisy)
        self._tables.clear()
        self._noises.clear()
        self._last = None

    def table(self, values: Vector) -> SpreadTable:
        key = tuple(float(values[i]) for i in sorted(self.shown))
        if key not in self._tables:
            table = self._transfer.table(self._image(values))
            if len(self._tables) >= _HELD:
                self._tables.clear()
            self._tables[key] = table
        return self._tables[key]

    def noise_residual(self, values: Vector) -> Vector:
        """Of the noise at the measured levels, in standard errors; nothing where it is not free."""
        if self.noise is None or not self.noisy:
            return np.zeros(0)
        key = tuple(float(values[i]) for i in sorted(self.noisy))
        noise = self._noises.get(key)
        if noise is None:
            try:
                noise = self.noise.residual(self.plan(values))
            except FAULTS:  # no noise with these values: they are far off
                noise = np.full(len(self.noise.measured), _OFF)
            if len(self._noises) >= _HELD:
                self._noises.clear()
            self._noises[key] = noise
        return noise

    def thinned(self) -> "EdgeProblem":
        order = np.argsort([patch.edge.angle_deg % 180.0 for patch in self.patches], kind="stable")
        taken = np.linspace(0, len(order) - 1, min(len(order), _THIN_EDGES)).astype(np.intp)
        patches = [self.patches[order[place]].thinned(_THIN) for place in taken]
        thin = EdgeProblem(self._engine, self._base, self._work, self.free, patches, self.noise)
        thin.shown, thin.noisy, thin.watch = self.shown, self.noisy, self.watch
        return thin

    @property
    def degrees(self) -> int:
        noise = len(self.noise.measured) if self.noise is not None and self.noisy else 0
        return self._fits.degrees + noise - len(self.free)

    def fitted(self, values: Vector) -> tuple[SpreadTable, EdgesAt]:
        if self._last is None or not np.array_equal(self._last[0], values):
            table = self.table(values)
            self._last = np.array(values), table, self._fits.at(table)
        return self._last[1], self._last[2]

    def freeze(self, values: Vector) -> None:
        """Take the weights that belong to these values from now on."""
        _, edges = self.fitted(values)
        self._fits.freeze(edges)
        self._last = None

    def beyond(self, values: Vector) -> list[Vector]:
        table, edges = self.fitted(values)
        spread = self._transfer.point_spread(self._image(values), reach=MARGIN)
        return [
            reaching_in(patch=patch, edges=edges, number=number, table=table, spread=spread)
            for number, patch in enumerate(self.patches)
        ]

    def leave_out_surroundings(self, values: Vector) -> float:
        """Take from the edges' samples what reaches into them from beyond.

        Returns the sum of squares by which that differs from what was left out before.
        """
        _, edges = self.fitted(values)
        change = self._fits.leave_out(self.beyond(values), edges.weight)
        self._last = None
        return change

    def residual(self, values: Vector) -> Vector:
        """Of all samples, in standard deviations."""
        _, edges = self.fitted(values)
        if self.watch is not None:
            self.watch(self.patches, edges)
        return np.concatenate([edges.residual.ravel(), self.noise_residual(values)])

    def cost(self, values: Vector) -> float:
        """Sum of squares; infinite for values that are not allowed."""
        try:
            noise = self.noise_residual(values)
            return self.fitted(values)[1].cost + float(noise @ noise)
        except FAULTS:
            return math.inf

    def derivative(self, values: Vector, index: int, other: float) -> Vector:
        _, edges = self.fitted(values)
        noise = self.noise_residual(values)
        changed = values.copy()
        changed[index] = other
        samples, louder = np.zeros(edges.residual.size), np.zeros(len(noise))
        if index in self.shown:
            samples = self._fits.derivative(edges, self.table(changed))
        if index in self.noisy:
            louder = self.noise_residual(changed) - noise
        return np.concatenate([samples, louder])

    def jacobian(self, values: Vector, scales: Vector, *, fine: bool = False) -> Matrix:
        columns = []
        for index, parameter in enumerate(self.free):
            step = (_FINE_STEP if fine else _STEP) * scales[index]
            here = float(values[index])
            up, down = min(here + step, parameter.high), max(here - step, parameter.low)
            if fine and up > here > down:
                difference = self.derivative(values, index, up)
                difference = difference - self.derivative(values, index, down)
                columns.append(difference / (up - down))
                continue
            there = up if up - here >= here - down else down
            columns.append(self.derivative(values, index, there) / (there - here))
        return np.column_stack(columns)


def fit_chain(problem: EdgeProblem) -> ChainFit:
    from scipy.optimize import least_squares

    free = problem.free
    problem.sort_out(np.array([chain_transfer.middle_of(parameter) for parameter in free]))
    thin = problem.thinned()
    begin = chain_transfer.starts(
        free, thin.cost, count=_STARTS if len(free) > 1 else 1, seed=_SEED
    )
    if not begin:
        raise DataError("no combination of values of the free parameters is allowed")
    lows = np.array([parameter.low for parameter in free])
    highs = np.array([parameter.high for parameter in free])

    def solved(on: EdgeProblem, start: Vector, most: int) -> tuple[Vector, float]:
        scales = scales_of(free, start)
        inside = np.clip(start, lows + 1e-9 * scales, highs - 1e-9 * scales)
        result = least_squares(
            on.residual, inside, jac=lambda v: on.jacobian(v, scales_of(free, v)),
            bounds=(lows, highs), x_scale="jac", xtol=1e-7, ftol=1e-9, max_nfev=most,
        )  # fmt: skip
        return np.asarray(result.x, np.float64), float(result.cost)

    thin.freeze(begin[0])
    first = sorted((solved(thin, start, _FIRST) for start in begin), key=lambda pair: pair[1])
    near = [v for v, cost in first if 2.0 * (cost - first[0][1]) < _RIVAL_THIN]
    followed = (solved(thin, start, _LAST) for start in chain_transfer.apart(near)[:_BEST])
    last = sorted(followed, key=lambda pair: pair[1])
    problem.leave_out_surroundings(last[0][0])
    problem.freeze(last[0][0])
    near = [v for v, cost in last if 2.0 * (cost - last[0][1]) < _RIVAL_THIN]
    ends = sorted(
        (solved(problem, v, _LAST) for v in chain_transfer.apart(near)), key=lambda pair: pair[1]
    )
    # What reaches into the edges depends on the solution, and that on what is left out.
    for _ in range(_ROUNDS):
        if problem.leave_out_surroundings(ends[0][0]) < _SETTLED:
            break
        problem.freeze(ends[0][0])
        nearest = solved(problem, ends[0][0], _LAST)
        ends = [nearest, *((v, 0.5 * problem.cost(v)) for v, _ in ends[1:])]
    # Of solutions alike, the one well inside the ranges: at an end of a width, where its square
    # alone counts, derivatives do not show that others do the same.
    alike = [pair for pair in ends if 2.0 * (pair[1] - ends[0][1]) < _SAME]
    values, best = max(alike, key=lambda pair: _inside(free, pair[0]))
    rivals = [v for v, cost in ends if 2.0 * (cost - best) < _RIVAL]
    values, unsigned = positive(free, problem.cost, values)
    scales = scales_of(free, values)
    table, edges = problem.fitted(values)
    shared = len(free), len(problem.noisy)
    misfit = misfit_of(edges, problem.noise_residual(values), problem.degrees, shared)
    jacobian = problem.jacobian(values, scales, fine=True)
    jacobian[: edges.residual.size] /= math.sqrt(misfit.excess)
    jacobian[edges.residual.size :] /= math.sqrt(misfit.noise_excess)
    rests_on: tuple[float, ...] = ()
    if misfit.excess > 1.0 and len(problem.patches) >= _FEWEST:
        residual, edge = of_each_edge(edges.residual / math.sqrt(misfit.excess), len(jacobian))
        jacobian, counts = widened_by_scatter(jacobian=jacobian, residual=residual, edge=edge)
        rests_on = tuple(map(float, counts))
    at_end = (end_of(p, float(v), float(s)) for p, v, s in zip(free, values, scales, strict=True))
    elsewhere = tuple(positive(free, problem.cost, v)[0] for v in chain_transfer.apart(rivals)[1:])
    return ChainFit(
        free, values, jacobian, problem.patches, edges, table, misfit, tuple(at_end),
        unsigned, elsewhere, problem.shown, rests_on,
    )  # fmt: skip


def _inside(free: Sequence[chain_transfer.FreeParameter], values: Vector) -> float:
    """How far the parameter that is nearest to the low end of its range is from it."""
    pairs = zip(free, values, strict=True)
    return min((float(value) - p.low) / abs(p.present or 1.0) for p, value in pairs)


def positive(
    free: Sequence[chain_transfer.FreeParameter], cost: Callable[[Vector], float], values: Vector
) -> tuple[Vector, tuple[int, ...]]:
    """Positive values where the sign changes nothing, as that of a defocus; and which these are."""
    unsigned = []
    for index, parameter in enumerate(free):
        if not (parameter.low < -abs(values[index]) < 0.0 and abs(values[index]) < parameter.high):
            continue
        other = values.copy()
        other[index] = -other[index]
        if abs(cost(other) - cost(values)) < _SAME:
            unsigned.append(index)
            values = values if values[index] > 0.0 else other
    return values, tuple(unsigned)


def scales_of(free: Sequence[chain_transfer.FreeParameter], values: Vector) -> Vector:
    """How much of each parameter counts as a change."""
    scales = []
    for parameter, value in zip(free, values, strict=True):
        width = parameter.high - parameter.low
        least = 1e-2 * min(width, abs(parameter.present or 1.0))
        scales.append(max(abs(float(value)), least))
    return np.array(scales)


def end_of(parameter: chain_transfer.FreeParameter, value: float, scale: float) -> str:
    if value - parameter.low <= _AT_END * scale:
        return "low"
    if parameter.high - value <= _AT_END * scale:
        return "high"
    return ""


# Errors of a fit from the scatter between edges, where they leave more than noise.
#
# Real edges are never ideal: what one leaves is of a shape of its own, the same in all its samples,
# and a sum of squares over samples takes it for many independent errors. Edges are independent of
# each other; so each is left out in turn, and what that moves is the error (Quenouille 1956, Tukey
# 1958: the jackknife; here one step of the linearized model for each). Of few edges the deviation
# is itself uncertain, and Student's distribution widens it.

_ALIKE = 3e-3  # of the largest singular value, below which a direction is not known at all
_RIDGE = 1e-9  # of what is known of a direction, where all of it stems from one edge
_LEAST_FREEDOM = 1.0  # degrees of freedom of a scatter


def widened_by_scatter(
    *, jacobian: Matrix, residual: Vector, edge: NDArray[np.intp]
) -> tuple[Matrix, Vector]:
    """Derivatives with which errors are at least those of the scatter between edges.

    `jacobian` holds derivatives of the residuals, shape (samples, parameters), in units of their
    errors; in `residual`, in the same units, what is each edge's own is taken out; `edge` is below
    0 for samples of none. Given are the derivatives, less where edges scatter by more than they
    say, and on how many edges each parameter rests: (Σ h)² / Σ h² of their shares h of its
    information.
    """
    lengths = np.linalg.norm(jacobian, axis=0) + 1e-300
    left, singular, rows = np.linalg.svd(jacobian / lengths, full_matrices=False)
    good = singular >= _ALIKE * singular[0]
    known = left[:, good]
    numbers = np.unique(edge[edge >= 0])
    parts = [known[edge == number] for number in numbers]
    shares = np.array([part.T @ part for part in parts])
    pairs = zip(parts, numbers, strict=True)
    scores = np.array([part.T @ residual[edge == number] for part, number in pairs])
    others = np.eye(known.shape[1]) * (1.0 + _RIDGE) - shares
    moved = np.linalg.solve(others, scores[..., np.newaxis])[..., 0]
    many = len(numbers)
    spread, axes = np.linalg.eigh((many - 1.0) / many * moved.T @ moved)
    wider = np.ones(len(spread))
    for place, axis in enumerate(axes.T):
        factor = student_factor(_count(shares, axis))
        wider[place] = max(1.0, float(spread[place]) * factor**2)
    left[:, good] = known @ (axes / np.sqrt(wider)) @ axes.T
    reached = (rows[good] / singular[good, np.newaxis]).T
    edges = np.array([_count(shares, one) for one in reached])
    return np.asarray((left * singular) @ rows * lengths, np.float64), edges


def of_each_edge(residual: Matrix, count: int) -> tuple[Vector, NDArray[np.intp]]:
    """Residuals in a row, with as many samples as that, and which edge each is of, or -1."""
    many, longest = residual.shape
    row, edge = np.zeros(count), np.full(count, -1, np.intp)
    row[: many * longest] = residual.ravel()
    edge[: many * longest] = np.repeat(np.arange(many), longest)
    return row, edge


def student_factor(edges: float) -> float:
    """By which a deviation of so few is multiplied for an interval that covers 68 %."""
    return float(special("stdtrit")(max(_LEAST_FREEDOM, edges - 1.0), special("ndtr")(1.0)))


def _count(shares: Matrix, axis: Vector) -> float:
    taken = np.einsum("i,eij,j->e", axis, shares, axis)
    total = float(taken.sum())
    return total**2 / float(taken @ taken) if total > 0.0 and math.isfinite(total) else 0.0
