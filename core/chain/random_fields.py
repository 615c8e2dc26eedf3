"""Random fields from counter-based streams: the same bits for any number of threads.

A stream is named by the network's seed, the node that draws and the field it draws. The name is
hashed to the key of a Philox generator; the samples are drawn in fixed blocks, each with its own
counter, so that a block depends on nothing but the stream and its own number.

Source: Salmon, Moraes, Dror and Shaw 2011, Parallel random numbers: as easy as 1, 2, 3.
"""

import dataclasses
import math
from collections.abc import Callable
from hashlib import blake2b
from typing import Any, TypeVar

import numpy as np
from numpy.random import Generator, Philox
from numpy.typing import DTypeLike, NDArray

from core.arrays import Array
from core.chain.back_transformed import Delivered, DeliveredBands
from core.chain.band_stack import AttenuatedBands, BandStack, SteppedBands
from core.chain.wires import Magnitude, Phase
from core.errors import DataError, ParameterError, require_finite
from core.evaluation.recipes import Recipe, Region, Step, furthest_first, runs
from core.evaluation.work import Work
from core.machine import Empty, ForEach, in_turn
from core.physics.optics.blur import gaussian_mtf
from core.records import dataclass, replace
from core.transfer import mirrored
from core.transfer.factors import Law, Planar, Separable

Floats = TypeVar("Floats", NDArray[np.float32], NDArray[np.float64])
_Draw = Callable[[Generator, Array], None]
_Work = Callable[[Generator, slice], None]

BLOCK = 1 << 17
"""Samples drawn from one counter; part of what defines a field. Shorter ones keep two threads
waiting for each other: 0.74 ms for 512² normals in place of 0.94."""

SPARSE_MEAN = 4.0  # up to it, drawing a block's events is faster than a deviate for every sample

NORMAL_LIMIT = 1e12
"""Poisson means above are drawn as rounded normals: exact to 1e-7 in probability, where the
rejection method would lose its accuracy to cancelling logarithms."""

_AT_ONCE = BLOCK // 2  # words drawn at a time: a block of normals in one go
_PLACE_BITS = (BLOCK - 1).bit_length()  # of a random word, that give a place in a block


@dataclass(frozen=True)
class Stream:
    """An endless supply of independent deviates, named by seed, node and field."""

    seed: int  # the network's seed, the node that draws, and the field's name
    node: str
    field: str
    frame: int = 0  # number of the frame in a sequence; a single picture is frame 0
    # Whether what is drawn belongs to the sensor and stays the same in every frame.
    fixed: bool = dataclasses.field(default=False, compare=False)

    @property
    def key(self) -> int:
        digest = blake2b(digest_size=16, person=b"imagechain noise")
        frame = (f"frame {self.frame}",) if self.frame else ()
        for part in (str(int(self.seed)), self.node, self.field, *frame):
            encoded = part.encode()
            digest.update(len(encoded).to_bytes(8, "little"))
            digest.update(encoded)
        return int.from_bytes(digest.digest(), "little")

    def generator(self, block: int) -> Generator:
        """Generator of one block; blocks are 2^128 draws apart."""
        return _generator(self.key, block)


def normal_field(
    stream: Stream,
    shape: tuple[int, ...],
    *,
    dtype: DTypeLike = np.float64,
    for_each: ForEach = in_turn,
) -> Array:
    """Standard normal deviates of a stream.

    float64 by the ziggurat; float32 by Box-Muller on 32-bit uniforms, three times as fast, none
    beyond 6.77. `for_each` calls a function on every block, in any order and from any thread, as
    `Work.for_each` does.

    Source: Marsaglia and Tsang 2000 (ziggurat); Box and Muller 1958.
    """
    draw = _box_muller if _is_single(dtype) else _ziggurat
    return _drawn(stream, np.empty(shape, dtype), draw, for_each)


def normal_part(
    stream: Stream,
    shape: tuple[int, int],
    region: Region,
    *,
    dtype: DTypeLike = np.float64,
    for_each: ForEach = in_turn,
) -> Array:
    """A region of the `normal_field` of that shape; no block outside it is drawn."""
    draw = _box_muller if _is_single(dtype) else _ziggurat
    (rows, columns), key, part = shape, stream.key, np.empty(region.shape, dtype)

    def one(block: int) -> None:
        start = block * BLOCK
        samples = np.empty(min(BLOCK, rows * columns - start), dtype)
        draw(_generator(key, block), samples)
        for run in runs(start, start + len(samples), columns):
            both = run.overlap(region)
            if both is not None:
                offset = run.top * columns + run.left - start
                lines = samples[offset : offset + run.rows * run.columns].reshape(run.shape)
                part[both.seen_from(region)] = lines[both.seen_from(run)]

    for_each(one, region.blocks(columns, BLOCK))
    return part


def uniform_field(
    stream: Stream,
    shape: tuple[int, ...],
    *,
    dtype: DTypeLike = np.float64,
    for_each: ForEach = in_turn,
) -> Array:
    """Deviates uniform in [0, 1); parameters as in `normal_field`."""
    _is_single(dtype)
    return _drawn(stream, np.empty(shape, dtype), _uniform, for_each)


def poisson_field(
    mean: Floats, stream: Stream, *, for_each: ForEach = in_turn, in_place: bool = False
) -> Floats:
    """Poisson deviates, one for each mean.

    Where the largest mean of a block is small, the block's events are drawn instead: their number
    is Poisson, their places are uniform, and an event stays with the probability mean/largest.
    The deviates then have exactly the Poisson distribution too (thinning).

    `mean` is float32 or float64 of any shape, 0 or above; the counts are alike. They take its place
    if `in_place`, and it must then be contiguous.

    Source: Lewis and Shedler 1979 (thinning); Hörmann 1993 (numpy's rejection above 10).
    """
    _is_single(mean.dtype)
    if mean.size and not (mean.min() >= 0.0 and mean.max() < np.inf):
        faulty = np.argwhere(~((mean >= 0.0) & (mean < np.inf)))
        first = tuple(int(place) for place in faulty[0])
        raise DataError(
            "Poisson means must be finite and 0 or above. Samples that are negative or not "
            f"finite: {len(faulty)} of {mean.size}; the first is {float(mean[first])!r} at {first}"
        )
    counts = mean if in_place else np.empty(mean.shape, mean.dtype)
    flat_counts, flat_means = counts.reshape(counts.size), np.ravel(mean)

    def draw(generator: Generator, block: slice) -> None:
        means = flat_means[block].copy() if in_place else flat_means[block]
        counts, largest = flat_counts[block], float(means.max())
        if largest == 0.0:
            counts[:] = 0.0
        elif largest <= SPARSE_MEAN:
            _thinned(generator, means, largest, counts)
        elif largest <= NORMAL_LIMIT:
            counts[:] = generator.poisson(means)
        else:
            _poisson_or_normal(generator, means, counts)

    if mean.size and mean.max() <= SPARSE_MEAN:
        for_each = in_turn  # drawing events is short work between numpy calls: threads only wait
    _for_each_block(stream, counts.size, draw, for_each)
    return counts


def _is_single(dtype: DTypeLike) -> bool:
    kind = np.dtype(dtype)
    if kind not in (np.dtype(np.float32), np.dtype(np.float64)):
        raise ParameterError("dtype", kind.name, "must be float32 or float64")
    return kind == np.dtype(np.float32)


def _generator(key: int, block: int) -> Generator:
    return Generator(Philox(key=key, counter=[0, 0, block, 0]))


def _drawn(stream: Stream, out: Array, draw: _Draw, for_each: ForEach) -> Array:
    flat = out.reshape(out.size)
    _for_each_block(
        stream, flat.size, lambda generator, block: draw(generator, flat[block]), for_each
    )
    return out


def _for_each_block(stream: Stream, size: int, work: _Work, for_each: ForEach) -> None:
    key = stream.key

    def one(block: int) -> None:
        work(_generator(key, block), slice(block * BLOCK, (block + 1) * BLOCK))

    for_each(one, range(-(-size // BLOCK)))


def _ziggurat(generator: Generator, out: Array) -> None:
    generator.standard_normal(out=out)


def _uniform(generator: Generator, out: Array) -> None:
    generator.random(out=out, dtype=out.dtype.type)


def _box_muller(generator: Generator, out: Array) -> None:
    for start in range(0, out.size, 2 * _AT_ONCE):
        _box_muller_pairs(generator, out[start : start + 2 * _AT_ONCE])


def _box_muller_pairs(generator: Generator, out: Array) -> None:
    half = (out.size + 1) // 2
    words = _words(generator, half).view(np.uint32)
    # Nothing is set aside for radii and angles: that costs as much as what is done to them.
    first, second = out[:half], out[half:]
    radius = second if len(second) == half else np.empty(half, np.float32)
    radius[:] = words[:half]
    radius += np.float32(0.5)  # keeps the logarithm finite
    radius *= np.float32(2.0**-32)
    np.log(radius, out=radius)
    radius *= np.float32(-2.0)
    np.sqrt(radius, out=radius)
    angle = words[:half].view(np.float32)  # in the place of the words that are radii now
    angle[:] = words[half:].view(np.int32)
    angle *= np.float32(np.pi / 2**31)
    np.cos(angle, out=first)
    first *= radius
    np.sin(angle, out=angle)
    np.multiply(radius[: len(second)], angle[: len(second)], out=second)


def _words(generator: Generator, count: int) -> NDArray[np.uint64]:
    words: NDArray[np.uint64] = generator.bit_generator.random_raw(count)
    return words


def _thinned(generator: Generator, mean: Array, largest: float, counts: Array) -> None:
    counts[:] = 0.0
    bits = max((mean.size - 1).bit_length(), 1)
    places = 1 << bits  # those beyond the block's end have mean 0
    left = int(generator.poisson(largest * places))
    unit = largest * 2.0 ** -(64 - _PLACE_BITS)
    while left > 0:
        words = _words(generator, min(left, _AT_ONCE))
        left -= words.size
        place = (words & np.uint64(places - 1)).astype(np.intp)
        words >>= np.uint64(_PLACE_BITS)  # what is left is independent of the place
        if places != mean.size:
            inside = place < mean.size
            place, words = place[inside], words[inside]
        accepted = words * unit < mean[place]
        np.add.at(counts, place, accepted.astype(counts.dtype))


def _poisson_or_normal(generator: Generator, mean: Array, counts: Array) -> None:
    means = mean.astype(np.float64)
    exact = generator.poisson(np.minimum(means, NORMAL_LIMIT)).astype(np.float64)
    normal = np.rint(means + np.sqrt(means) * generator.standard_normal(means.size))
    np.minimum(normal, float(np.finfo(counts.dtype).max), out=normal)
    counts[:] = np.where(means > NORMAL_LIMIT, normal, exact)


# The number of a frame, for what changes from frame to frame by a law and not by fresh draws.


@dataclass(frozen=True)
class FrameNumber:
    """Stands among a step's or a law's parameters; a sequence puts each frame's own in its place.

    A single picture is frame 0, those before it are negative.
    """

    frame: int = 0


# Poisson deviates about a blurred picture, event by event, without blurring the picture.
#
# Events of a Poisson process that move independently of each other form a Poisson process again,
# whose intensity is the first one's spread by the distribution of the moves. So an event is drawn
# at a place weighted by the picture, and then moved by a Gaussian step: exactly the deviates that
# the Gaussian-weighted local mean calls for, at the cost of the events alone.
#
# Source: Kingman 1993, Poisson Processes, section 5.1 (displacement theorem); Lewis and Shedler
# 1979 (thinning).


EVENTS_BLOCK = 1 << 20
"""Samples whose events come from one counter; part of what defines a field."""

LEAST_SIGMA_PX = 2.5
"""From here on sampled Gaussian weights are those of the Gaussian transfer function, to 1e-13."""

LARGEST_SIGMA_PX = 1e4
"""Up to here the table of weights is small; wider ones blur the picture instead."""

MOST = 0.08
"""Largest mean of a sample that is drawn by events. Measured at 1024² in one thread: 0.5 ms for a
mean of 0.003, 6.6 ms for 0.07; the blurred picture and its deviates take 7 to 8 ms."""

_REACH = 8.5  # standard deviations; less than 2e-17 of the weight is beyond


def events_are_few(picture: Array, *, share: float, sigma_px: float) -> bool:
    """Whether `displaced_events` serves, and is faster than blurring the picture."""
    if not LEAST_SIGMA_PX <= sigma_px <= LARGEST_SIGMA_PX:
        return False
    return bool(picture.min() >= 0 and share * float(picture.max()) <= MOST)


def displaced_events(
    picture: Array,
    stream: Stream,
    *,
    share: float,
    sigma_px: float,
    for_each: ForEach = in_turn,
    empty: Empty = np.empty,
) -> Array:
    """Poisson deviates whose means are `share` of the picture's Gaussian-weighted local mean.

    The picture, (rows, columns), has samples of 0 or above and is mirrored beyond its edges.
    `share` are events per unit of it, `sigma_px` the standard deviation of the weights along each
    axis in samples, `LEAST_SIGMA_PX` to `LARGEST_SIGMA_PX`. The counts have the picture's shape and
    type.
    """
    flat = np.ravel(picture)
    steps = _gaussian_steps(sigma_px)
    places_by_block: dict[int, Array] = {}

    def one(block: int) -> None:
        generator = stream.generator(block)
        source = flat[block * EVENTS_BLOCK : (block + 1) * EVENTS_BLOCK]
        places = _drawn_places(generator, source, share) + block * EVENTS_BLOCK
        moves = np.searchsorted(steps, generator.random((2, len(places)))) - len(steps) // 2
        rows, columns = np.divmod(places, picture.shape[1])
        rows = _mirrored(rows + moves[0], picture.shape[0])
        columns = _mirrored(columns + moves[1], picture.shape[1])
        places_by_block[block] = rows * picture.shape[1] + columns

    for_each(one, range(-(-flat.size // EVENTS_BLOCK)))
    counts = empty((flat.size,), picture.dtype)
    counts.fill(0)
    for places in places_by_block.values():
        np.add.at(counts, places, picture.dtype.type(1))
    return counts.reshape(picture.shape)


def _drawn_places(generator: np.random.Generator, means: Array, share: float) -> Array:
    """Where events happen: thinned from a constant rate."""
    largest = float(means.max())
    count = generator.poisson(share * largest * means.size)
    places = generator.integers(0, means.size, size=count)
    return np.asarray(places[generator.random(count) * largest < means[places]])


def _gaussian_steps(sigma_px: float) -> Array:
    """Cumulated weights of the steps −n … n, the last left out."""
    reach = int(np.ceil(_REACH * sigma_px))
    steps = np.arange(-reach, reach + 1)
    weights = np.exp(-0.5 * np.square(steps / sigma_px))
    below = np.cumsum(weights)
    return np.asarray(below[:-1] / below[-1])


def _mirrored(places: Array, size: int) -> Array:
    places = places % (2 * size)
    return np.asarray(np.minimum(places, 2 * size - 1 - places))


# Gaussian-weighted local mean of a mirrored frame, by its low frequencies alone.
#
# A Gaussian of five samples is below rounding beyond two fifths of the band, so that most columns
# of the transforms hold nothing and are left out.


def local_mean(work: Work, image: Array, *, sigma_px: float) -> Array:
    """Gaussian-weighted mean around each sample, the frame mirrored at its edges; a new array.

    `sigma_px` is the standard deviation of the weights in samples; 0 gives the picture itself.
    """
    dtype = work.policy.dtype
    made: Array = work.empty(image.shape)
    if sigma_px == 0:
        made[...] = image
        return made
    mean = float(np.mean(image))
    along, across = (_response(size, sigma_px, dtype) for size in image.shape)
    width = len(across)  # of the columns that hold something
    lines = work.strips((image.shape[0], width))

    def spread(rows: slice) -> None:
        part = mirrored.transform_block(np.subtract(image[rows], mean, dtype=dtype), "dct", axis=1)
        lines[rows] = part[:, :width] * across

    def blur(block: Array) -> None:
        values = mirrored.transform_block(np.ascontiguousarray(block), "dct", axis=0)
        values[: len(along)] *= along[:, np.newaxis]
        values[len(along) :] = 0
        block[...] = mirrored.transform_block(values, "idct", axis=0)

    def gather(rows: slice) -> None:
        part = np.zeros((len(image[rows]), image.shape[1]), dtype)
        part[:, :width] = lines[rows]
        part = mirrored.transform_block(part, "idct", axis=1)
        require_finite(part)
        part += dtype.type(mean)
        made[rows] = part

    work.for_each(spread, mirrored.row_blocks(image.shape))
    work.for_each(blur, mirrored.column_blocks(lines))
    work.for_each(gather, mirrored.row_blocks(image.shape))
    return made


def _response(size: int, sigma_px: float, dtype: np.dtype[Any]) -> Array:
    """The Gaussian's response at k/(2·size) up to where it is below rounding."""
    # exp(−2π²σ²f²) = rounding / 64 at this frequency in cycles a sample
    faintest = float(np.finfo(dtype).eps) / 64
    limit = math.sqrt(-math.log(faintest) / 2) / (math.pi * sigma_px)
    count = min(size, math.floor(min(limit * 2 * size, size)) + 1)
    response = gaussian_mtf(frequency=np.arange(count) / (2 * size), sigma_mrad=sigma_px)
    return response.astype(dtype)


# Further frames of a sequence: the same picture with temporal noise of its own.
#
# A frame differs from the picture in its noise streams alone, and not in those of a sensor's fixed
# patterns, and in what is made of its number; all that leads to these keeps its key, so it is made
# once for all frames.

Change = Callable[[Recipe], Recipe | None]
Wire = TypeVar("Wire", Magnitude, Phase)


def at_frame(recipe: Recipe, frame: int) -> Recipe:
    """The recipe of the same picture so many frames later; frame 0 is the picture itself."""

    def change(step: Recipe) -> Recipe | None:
        if isinstance(step, Delivered):
            same = made.inputs_of(step)
            assert isinstance(same, Delivered)
            # Its transfer functions may have the number of the frame.
            wires = _wire_later(same.magnitude, frame), _wire_later(same.phase, frame)
            return _with_wires(same, *wires)
        if not isinstance(step, Step):
            return None
        moved = tuple((name, _moved(value, frame)) for name, value in step.parameters)
        if moved == step.parameters:
            return None
        inputs = tuple(made.of(one) for one in step.inputs)
        return replace(step, inputs=inputs, parameters=moved)

    made = Remaking(change)
    return made.of(recipe)


def _with_wires(delivered: Delivered, magnitude: Magnitude, phase: Phase) -> Delivered:
    """With other wires; the same object where these are its own."""
    if magnitude is delivered.magnitude and phase is delivered.phase:
        return delivered
    return replace(delivered, magnitude=magnitude, phase=phase)


def _wire_later(wire: Wire, frame: int) -> Wire:
    factors = _moved(wire.factors, frame)
    return wire if factors is wire.factors else replace(wire, factors=factors)


def _moved(value: Any, frame: int) -> Any:
    """A parameter in the other frame; the same object where it does not change."""
    if isinstance(value, FrameNumber) or (isinstance(value, Stream) and not value.fixed):
        return replace(value, frame=value.frame + frame) if frame else value
    if isinstance(value, Separable):
        x, y = _moved(value.x, frame), _moved(value.y, frame)
        return value if x is value.x and y is value.y else replace(value, x=x, y=y)
    if isinstance(value, Planar):
        law = _moved(value.law, frame)
        return value if law is value.law else replace(value, law=law)
    if isinstance(value, Law):
        bound = tuple((name, _moved(part, frame)) for name, part in value.parameters)
        return value if bound == value.parameters else replace(value, parameters=bound)
    if isinstance(value, tuple):
        parts = tuple(_moved(part, frame) for part in value)
        same = all(new is old for new, old in zip(parts, value, strict=True))
        return value if same else parts
    return value


def _pictures(recipe: Recipe) -> tuple[Recipe, ...]:
    """What a recipe is made of, less what transfer functions are."""
    if isinstance(recipe, Delivered):
        wires = (recipe.magnitude, recipe.phase)
        return tuple(wire.image.recipe for wire in wires if wire.image is not None)
    return recipe.inputs if isinstance(recipe, Step) else ()


class Remaking:
    """Makes recipes anew with some of those they are made of changed.

    `change` is called with each recipe: what takes its place, or None to look at its inputs
    instead.
    """

    def __init__(self, change: Change) -> None:
        self._change = change
        self._known: dict[str, Recipe] = {}

    def of(self, recipe: Recipe) -> Recipe:
        """The recipe remade; the same object where nothing changes."""
        known = self._known
        for part in furthest_first([recipe], _pictures, lambda one: one.key in known):
            known[part.key] = self._change(part) or self.inputs_of(part)
        return known[recipe.key]

    def inputs_of(self, recipe: Recipe) -> Recipe:
        """The recipe with its inputs remade; those of transfer functions are left alone."""
        if isinstance(recipe, Step):
            inputs = tuple(self.of(part) for part in recipe.inputs)
            same = all(a is b for a, b in zip(inputs, recipe.inputs, strict=True))
            return recipe if same else replace(recipe, inputs=inputs)
        if isinstance(recipe, Delivered):
            return _with_wires(recipe, self._wire(recipe.magnitude), self._wire(recipe.phase))
        return recipe

    def _wire(self, wire: Wire) -> Wire:
        if wire.image is None:
            return wire
        made = self.of(wire.image.recipe)
        if made is wire.image.recipe:
            return wire
        bands = None if wire.image.bands is None else self._bands(wire.image.bands)
        return replace(wire, image=wire.image.with_recipe(made, bands=bands))

    def _bands(self, bands: BandStack) -> BandStack:
        if isinstance(bands, DeliveredBands):
            delivered = self.of(bands.delivered)
            assert isinstance(delivered, Delivered)
            return DeliveredBands.of(delivered)
        if isinstance(bands, AttenuatedBands | SteppedBands):
            return replace(bands, before=self._bands(bands.before))
        return bands
