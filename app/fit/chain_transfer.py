"""The chain in a fit: its free parameters, and what it does to an ideal edge along its normal."""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.fit.edge_fit import HIGHEST, SpreadTable, frequencies, spread_table
from app.run.option_values import Assignment, assignment, low_high
from app.run.overrides import behind, named_parameter
from app.run.transfer_chain import HOW_TO_MARK, HOW_TO_NAME, find_chain, find_output
from core import kernels
from core.arrays import Complex, Vector
from core.chain.engine import Engine, Plan, PlannedNode
from core.chain.step_lineage import lineage_of, source_step
from core.chain.wires import Image
from core.errors import DataError, UsageError, several
from core.evaluation.recipes import Step
from core.evaluation.work import Work
from core.modules.declaration import Library, declaration
from core.modules.parameters import Parameter
from core.network.network import EXPRESSION, Network
from core.physics.detector.detector_mtf import aperture_mtf
from core.physics.measurement.sample_noise import LevelVariance
from core.physics.numerics import sinc
from core.physics.sampling.detector_sampling import block_mean_mtf
from core.records import dataclass, replace
from core.transfer.factors import Factor, Planar, Separable
from nodes.analysis.lineage import ImageNoise, ImageTransfer, NoiseOf, transfer_of
from nodes.transform.resampling import InterpolationMTF

FREE = "--free"
_FORM = "NODE.PARAM, or NODE.PARAM=LOW:HIGH"
_MOST = 8  # names in a message
_ABOVE = 1e-12  # of a range whose low end is no value: above it


@dataclass(frozen=True)
class FreeParameter:
    port: str  # ``NODE.PARAM`` as it was given
    node: str  # where it is, inside a macro too
    name: str
    low: float  # between what; infinite where the parameter has no end
    high: float
    present: float | None  # its value in the network; None where it is empty there
    unit: str  # of the parameter

    @property
    def target(self) -> tuple[str, str]:
        return self.node, self.name


def free_parameters(
    texts: Sequence[str], network: Network, library: Library, *, option: str = FREE
) -> tuple[FreeParameter, ...]:
    """The parameters that are named; `option` is what named them, for messages."""
    if not texts:
        raise UsageError(
            f"{option}: name a parameter to fit{_such_as(numbers_of(network, library))}"
        )
    free = tuple(_one(text, network, library, option) for text in texts)
    seen: set[tuple[str, str]] = set()
    for parameter in free:
        if parameter.target in seen:
            raise UsageError(f"{option} {parameter.port} is given more than once")
        seen.add(parameter.target)
    return free


def numbers_of(network: Network, library: Library) -> list[str]:
    """``NODE.PARAM`` of every number that may be fitted, but those of the network's sources."""
    found = []
    for key, node in network.nodes.items():
        module, links = library.get(node.module), network.links_into(key)
        if module is None or node.disabled or not links:
            continue
        is_stage = any(link.input == "context" for link in links)
        found += [
            (not is_stage, p.name not in node.params, f"{key}.{p.name}")
            for p in declaration(module).parameters
            if p.kind == "number"
        ]
    return [name for *_, name in sorted(found, key=lambda one: one[:2])]


def _such_as(names: Sequence[str]) -> str:
    if not names:
        return ""
    more = f", or {several(len(names) - _MOST, 'other')}" if len(names) > _MOST else ""
    return f", such as {', '.join(names[:_MOST])}{more}"


def _given(text: str, network: Network, library: Library, option: str) -> Assignment:
    """The parts of what was given; a node or a parameter alone is completed in the message."""
    name, equals, ends = text.partition("=")
    if "." in name:
        return assignment(option, f"{name}={ends}", _FORM)
    numbers = numbers_of(network, library)
    like = [one for one in numbers if name in one.split(".")]
    raise UsageError(
        f"{option} {text!r:.120} is not allowed: must be {_FORM}{_such_as(like or numbers)}"
        if name or equals
        else f"{option}: name a parameter to fit{_such_as(numbers)}"
    )


def _one(text: str, network: Network, library: Library, called: str) -> FreeParameter:
    given = _given(text, network, library, called)
    target = behind(given, network)
    declared = named_parameter(called, target, network, library=library)
    if declared is None:
        raise UsageError(f"{called} {given.port}: the node's module is unknown")
    option = f"{called} {given.port}"
    if declared.kind != "number":
        raise UsageError(
            f"{option}: {declared.name} is {declared.allowed()}; only a parameter with a range "
            "of numbers can be fitted"
        )
    raw = network.nodes[target.node].params.get(target.name, declared.default)
    if isinstance(raw, Mapping) and EXPRESSION in raw:
        raise UsageError(
            f"{option}: an expression computes this parameter; fit the parameters in the "
            "expression instead"
        )
    low, high = _range(declared, target.text, option)
    present = float(raw) if isinstance(raw, int | float) else None
    ends, unit = (low, high), declared.param.unit
    return FreeParameter(given.port, target.node, target.name, *ends, present, unit)


def _range(declared: Parameter, text: str, option: str) -> tuple[float, float]:
    own_low = -math.inf if declared.param.low is None else float(declared.param.low)
    own_high = math.inf if declared.param.high is None else float(declared.param.high)
    end = own_low
    if math.isfinite(end) and (declared.param.above or declared.coerce(end) is None):
        own_low = end + _ABOVE * max(1.0, abs(end))
    if not text:
        return own_low, own_high
    low, high = low_high(option, text)
    if low == end:
        low = own_low
    if low < own_low or high > own_high:
        raise UsageError(f"{option}={text:.80}: {declared.name} is {declared.allowed()}")
    return low, high


# Where the fit begins: places over the whole range of each free parameter, the best of them.

Cost = Callable[[Vector], float]

_PLACES = 13
_WIDE = 30.0  # an end over the other, from which on places are equal factors apart
_FAR = 1000.0  # times the present value, beyond which the end of a range says nothing
_DECADES_KNOWN, _DECADES_UNKNOWN = 1.5, 4.0  # about the present value, or about 1
_SHARES = 1e-4, 0.3  # of a range to both sides of 0, in equal factors
_ROUNDS = 2
_DRAWN = 32  # sets for each parameter beyond the first
_APART = 0.3  # of a value, between starts
_DIFFERENT = 0.05  # of values, between solutions


def places(parameter: FreeParameter) -> Vector:
    """Numbers over the range of a parameter: equal steps, and factors about its present value."""
    low, high, now = parameter.low, parameter.high, parameter.present
    scale = abs(now) if now else 1.0
    if low > 0.0 and high / low >= _WIDE and high / low <= _FAR:
        return np.geomspace(low, high, _PLACES)
    if low < 0.0 < high and not now:
        # Such as ±20 waves of defocus: most of it is far beyond what any picture shows.
        shares = np.geomspace(*_SHARES, _PLACES)
        return np.sort(np.concatenate([low * shares, high * shares]))
    if high - low <= (_WIDE if low < 0.0 else _FAR) * scale:
        inside = (high - low) * 1e-3
        grid = np.linspace(low + inside, high - inside, _PLACES)
        if not now or low > 0.0:
            return grid
        about = now * np.geomspace(0.03, 30.0, _PLACES)
        return np.unique(np.concatenate([grid, about[(about > low) & (about < high)]]))
    decades = _DECADES_KNOWN if now else _DECADES_UNKNOWN
    first = max(scale * 10.0**-decades, low if low > 0.0 else 0.0)
    last = min(scale * 10.0**decades, high)
    if last <= first:  # the whole range lies beside the present value
        first, last = (low, high) if low > 0.0 else (1e-4 * high, high)
    step = 10.0 ** (1.0 / 6.0)
    count = max(_PLACES, math.ceil(math.log(last / first) / math.log(step)) + 1)
    upper = np.geomspace(first, last, count)
    if low < 0.0:
        lower = -upper[(-upper >= low)]
        return np.sort(np.concatenate([lower, upper]))
    return upper


def starts(free: Sequence[FreeParameter], cost: Cost, *, count: int, seed: int) -> list[Vector]:
    """Values from which to go downhill, the best first."""
    grids = [places(parameter) for parameter in free]
    here = np.array([_begin(p, grid) for p, grid in zip(free, grids, strict=True)])
    seen: dict[tuple[float, ...], float] = {}

    def looked_at(values: Vector) -> float:
        key = tuple(float(v) for v in values)
        if key not in seen:
            seen[key] = cost(values)
        return seen[key]

    looked_at(here)
    rounds = _ROUNDS if len(free) > 1 else 1
    for _, index in itertools.product(range(rounds), range(len(free))):
        varied = np.arange(len(free)) == index
        trials = [np.where(varied, value, here) for value in grids[index]]
        here = min([here, *trials], key=looked_at)
    if len(free) > 1:
        generator = np.random.default_rng(seed)
        count_drawn = _DRAWN * (len(free) - 1)
        columns = [generator.permutation(np.linspace(0, len(g) - 1, count_drawn)) for g in grids]
        for number in range(count_drawn):
            drawn = [g[round(c[number])] for g, c in zip(grids, columns, strict=True)]
            looked_at(np.array(drawn))
    chosen: list[Vector] = []
    for key in sorted(seen, key=lambda k: seen[k]):
        values = np.array(key)
        if not math.isfinite(seen[key]):
            break
        if all(_is_apart(values, other) for other in chosen):
            chosen.append(values)
        if len(chosen) == count:
            break
    return chosen


def _begin(parameter: FreeParameter, grid: Vector) -> float:
    now = parameter.present
    if now is not None and parameter.low < now < parameter.high:
        return now
    return float(grid[len(grid) // 2])


def _is_apart(one: Vector, other: Vector) -> bool:
    scale = np.maximum(np.abs(one), np.abs(other)) + 1e-300
    return bool(np.max(np.abs(one - other) / scale) > _APART)


def apart(solutions: Sequence[Vector]) -> list[Vector]:
    """Those that differ, but for a sign, from all before them."""
    chosen: list[Vector] = []
    for one in solutions:
        if all(
            np.max(np.abs(np.abs(one) - np.abs(other)) / (np.abs(one) + np.abs(other) + 1e-300))
            > _DIFFERENT
            for other in chosen
        ):
            chosen.append(one)
    return chosen


def middle_of(parameter: FreeParameter) -> float:
    now = parameter.present
    if now is not None and now != 0.0 and parameter.low < now < parameter.high:
        return now
    grid = places(parameter)
    return float(grid[len(grid) // 2])


def inner(parameter: FreeParameter) -> tuple[float, ...]:
    """Values a quarter of the places from both ends."""
    grid = places(parameter)
    return float(grid[len(grid) // 4]), float(grid[(3 * len(grid)) // 4])


# The edge takes the place of the source, and no samples blur it. Where pixels are combined from the
# source's samples, or nothing averages over an area, the samples' area is the pixel's.


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
        if isinstance(factor, InterpolationMTF):
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


class NoiseProblem:
    """What the network predicts of the noise that was measured at some levels."""

    def __init__(
        self, engine: Engine, plan: Plan, work: Work, measured: Sequence[LevelVariance] = ()
    ) -> None:
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
        self.measured = tuple(one for one in measured if one.variance > 0.0)
        variance = np.array([one.variance for one in self.measured])
        error = np.array([one.variance_error for one in self.measured])
        self._log, self._error = np.log(variance), np.maximum(error / variance, 1e-3)

    def predicted(self, plan: Plan) -> Vector:
        return self.at(plan, [one.level for one in self.measured])

    def residual(self, plan: Plan) -> Vector:
        """Predicted less measured logarithms (variances begin orders apart), in standard errors."""
        predicted = np.maximum(self.predicted(plan), 1e-300)
        return np.asarray((np.log(predicted) - self._log) / self._error, np.float64)

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
