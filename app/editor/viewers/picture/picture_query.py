"""The query of an image viewer: what is on a wire, as a picture ready to be shown, and in words."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from app.editor.evaluation.queries import Passing, Query
from app.editor.viewers.picture import picture_facts
from app.editor.viewers.viewer import PICTURE_TYPES, followed
from core.arrays import Array
from core.chain import band_stack, engine, wires
from core.errors import DataError, ImagechainError, NetworkError, watched
from core.evaluation.recipes import Recipe, Step, ends_lineage, number_bits
from core.evaluation.work import Work
from core.modules.preview import signed
from core.network.network import Network
from core.records import dataclass, replace
from nodes.files.formats import check_finite
from nodes.input_output.examine_image import apparent_temperature, logarithm
from nodes.shared.context_defaults import is_radiance

INNER = (0.005, 0.995)
WHOLE: picture_facts.Range = (0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Channel:
    samples: NDArray[Any]  # shape (rows, columns): its samples, not mapped
    # extremes and histogram of the mapped samples, as shares of what lies between its automatic
    # levels: 0 at the lower one, 1 at the upper
    spread: picture_facts.Spread
    ends: picture_facts.Range  # these levels


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture ready to be shown. All arrays are read-only."""

    facts: picture_facts.Facts  # what it is
    # shape (rows, columns): the samples as the probe shows them, not mapped; of a composite those
    # of its red
    samples: NDArray[Any]
    # shape (rows, columns) or (rows, columns, 3): the mapped samples from black to white; of a
    # composite red, green and blue
    grey: NDArray[np.uint8]
    # mapped values of black and white; of a composite shares, as its channels' spreads have
    levels: picture_facts.Range
    # extremes and histogram of the mapped samples; of a composite the extremes alone
    spread: picture_facts.Spread
    # how samples are mapped; otherwise than linear they are shown by their decimal logarithm, but
    # for planes, which are spectra already
    mapping: picture_facts.Scale
    value: Any  # what is on the wire, for writing files
    other: Picture | None = None  # the other half of a wipe
    reduced: int = 1  # above 1 in a preview
    # why the kept picture it was to be compared with is not its other half, in one line
    refused: str = ""
    channels: tuple[Channel, ...] = ()  # red, green and blue of a composite; else empty

    @property
    def logarithmic(self) -> bool:
        is_spectrum = isinstance(self.value, wires.Image) and self.mapping == "spectrum"
        return self.mapping == "log" or is_spectrum


@dataclass(frozen=True, eq=False)
class KeptPicture:
    """What was on a wire in an earlier state. Its arrays are read-only, and shared, not copied."""

    port: str  # ``NODE.PORT``
    value: Any  # what was on the wire
    samples: NDArray[Any]  # shape (rows, columns): the samples, not mapped
    facts: picture_facts.Facts  # what they are


@dataclass(frozen=True)
class PictureQuery(Query):
    urgency: ClassVar[int] = 0
    from_preview: ClassVar[bool] = True

    port: str = ""  # ``NODE.PORT``; empty for none
    other: str | None = None  # a second wire, for `mode`
    # the first alone, both to be shown side by side, or the first less the second
    mode: picture_facts.Mode = "alone"
    # samples as they are, the logarithm of their modulus, or the logarithm of the modulus of an
    # image's spectrum
    mapping: picture_facts.Scale = "linear"
    # what becomes black and white: the extremes, the quantiles of 0.5 % and 99.5 %, or these mapped
    # values. A linear difference has automatic levels that put 0 in the middle. Every colour of a
    # composite has its own; two numbers are then shares of what lies between these
    levels: picture_facts.Levels = "extremes"
    # an earlier state's picture, as the other half: mapped as the present one is, to its levels
    kept: KeptPicture | None = None
    bands: picture_facts.BandChoice = picture_facts.ALL  # what is shown of pictures with bands

    def with_(self, **changes: Any) -> PictureQuery:
        """With some of it changed; manual levels hold only for what they were set for."""
        changed = replace(self, **changes)
        meant_for = ("port", "other", "mode", "mapping")
        otherwise = any(getattr(self, name) != getattr(changed, name) for name in meant_for)
        # Of another band in the same place they hold, so that bands can be compared.
        otherwise = otherwise or self.bands.shown != changed.bands.shown
        if otherwise and "levels" not in changes and not isinstance(changed.levels, str):
            return replace(changed, levels=picture_facts.AUTOMATIC_LEVELS)
        return changed

    @property
    def compares(self) -> bool:
        return self.mode != "alone" and self.other is not None

    def moved(self, before: Network, after: Network) -> PictureQuery:
        """With the names that nodes have after a change; those of nodes that are gone stay."""
        port = followed(self.port, before, after) or self.port
        other = self.other and (followed(self.other, before, after) or self.other)
        return replace(self, port=port, other=other)

    def key(self, plan: engine.Plan) -> Hashable:
        ports = (self.port, str(self.other)) if self.compares else (self.port,)
        return self, *(picture_facts.identity(self._value(plan, port)) for port in ports)

    def answer(self, passing: Passing) -> Picture:
        first = self._source(passing, self.port)
        if self.kept is not None:
            return self._beside(passing, self._shown(passing, first, self.levels), self.kept)
        if not self.compares or self.other is None:
            return self._shown(passing, first, self.levels)
        second = self._source(passing, self.other)
        if self.mode == "difference":
            return self._shown(passing, _less(first, second), self.levels)
        left = self._shown(passing, first, self.levels)
        same = left.facts.unit == second.facts.unit and left.facts.kind == second.facts.kind
        if same and len(first.recipes) == len(second.recipes):
            right = self._shown(passing, second, left.levels, left.channels)
        else:
            automatic: picture_facts.Levels = (
                self.levels if isinstance(self.levels, str) else "extremes"
            )
            right = self._shown(passing, second, automatic)
        return replace(left, other=right)

    def kept_picture(self, passing: Passing) -> KeptPicture:
        """What is on the wire now, to be compared with what will be."""
        source = self._source(passing, self.port)
        with _errors_at(self.port):
            (recipe,) = source.recipes
            samples = passing.work.value(recipe)
            passing.work.value(Step.of(finite_spread, recipe, name=self.port))  # else refused
        return KeptPicture(self.port, source.value, samples, source.facts)

    def _beside(self, passing: Passing, now: Picture, kept: KeptPicture) -> Picture:
        work, samples, facts = passing.work, kept.samples, kept.facts
        source = self._of_image(kept.port, kept.value, 1) if now.facts.wavelengths_um else None
        if source is not None:
            facts = self._drawn_facts(source)
        elif self.mapping == "spectrum" and isinstance(kept.value, wires.Image):
            samples, facts = (
                centred_modulus(work, samples),
                picture_facts.spectrum_facts(kept.value),
            )
        shown = now.facts
        if passing.reduced > 1:  # a preview has fewer samples: their number is known later
            shown = replace(shown, rows=facts.rows, columns=facts.columns)
        refused = why_not_compared(facts, shown)
        if refused:
            return replace(now, refused=refused)
        if source is not None:
            return replace(now, other=self._shown(passing, source, now.levels, now.channels))
        log = self.mapping == "log" or samples is not kept.samples
        mapped = logarithm(work, samples) if log else samples
        work.check()
        grey = picture_facts.grey_levels(mapped, *now.levels, for_each=work.for_each)
        grey.flags.writeable = False
        other = replace(now, facts=facts, samples=samples, grey=grey, value=kept.value)
        return replace(now, other=other)

    def _value(self, plan: engine.Plan, port: str) -> Any:
        value = plan.output(port)
        kind = getattr(value, "port_type", None)
        if kind not in PICTURE_TYPES:
            shown = f"{', '.join(PICTURE_TYPES[:-1])} and {PICTURE_TYPES[-1]}"
            raise NetworkError(f"{port} is of type {kind}: only {shown} can be shown as pictures")
        return value

    def _source(self, passing: Passing, port: str) -> _Source:
        value = self._value(passing.plan, port)
        node = port.rpartition(".")[0]
        work = passing.work
        if isinstance(value, wires.Image):
            return self._of_image(port, value, passing.reduced)
        if isinstance(value, wires.Pupil):
            recipe = Step.of(real, value.samples, node=node)
            return _Source(port, value, (recipe,), picture_facts.pupil_facts(value))
        work.log.looked_at.add(value.key)
        recipe = Step.of(centred_plane, node=node, value=value)
        own = work.value(value.own) if isinstance(value, wires.Transfer) and value.own else None
        rows, columns = value.grid.shape if own is None else own.values.shape
        return _Source(port, value, (recipe,), picture_facts.plane_facts(value, rows, columns, own))

    def _of_image(self, port: str, image: wires.Image, reduced: int) -> _Source:
        facts = picture_facts.image_facts(image, reduced)
        places = () if image.bands is None else self.bands.places(image.bands)
        if image.bands is None or not places:
            return _Source(port, image, (image.recipe,), facts)
        return _Source(
            port,
            image,
            _recipes(image.bands, places),
            picture_facts.of_bands(facts, image.bands, places),
        )

    def _drawn_facts(self, source: _Source) -> picture_facts.Facts:
        """Of the samples, or of their spectrum where that is shown."""
        facts = source.facts
        if self.mapping != "spectrum" or not isinstance(source.value, wires.Image):
            return facts
        modulus = picture_facts.spectrum_facts(source.value)
        return replace(modulus, unit=facts.unit, wavelengths_um=facts.wavelengths_um)

    def _shown(
        self,
        passing: Passing,
        source: _Source,
        levels: picture_facts.Levels,
        like: tuple[Channel, ...] = (),
    ) -> Picture:
        facts = self._drawn_facts(source)
        channels: tuple[Channel, ...] = ()
        with _errors_at(source.port):
            layers = [self._layer(passing.work, source, recipe) for recipe in source.recipes]
            if len(layers) == 1:
                (layer,) = layers
                drawn = layer.range_of(passing.work, levels)
                grey, spread = layer.grey(passing.work, drawn), layer.spread
            else:
                grey, drawn, channels = composed(passing.work, layers, levels, like)
                ends = [end for one in channels for end in (one.spread.low, one.spread.high)]
                spread = picture_facts.Spread(
                    min(ends), max(ends), np.zeros(picture_facts.BINS, np.int64)
                )
        grey.flags.writeable = False
        return Picture(
            facts,
            layers[0].shown,
            grey,
            drawn,
            spread,
            self.mapping,
            source.value,
            reduced=passing.reduced,
            channels=channels,
        )

    def _layer(self, work: Work, source: _Source, recipe: Recipe) -> Layer:
        plain = recipe
        if self.mapping == "spectrum" and isinstance(source.value, wires.Image):
            recipe = Step.of(centred_modulus, recipe)
        log = self.mapping == "log" or recipe is not plain
        mapped = Step.of(logarithm, recipe) if log else recipe
        samples = work.value(mapped)
        step = Step.of(finite_spread, mapped, name=source.port)
        signed = source.signed and not log
        bits = number_bits(mapped)
        return Layer(work.value(recipe), samples, work.value(step), mapped, step, signed, bits)


@contextmanager
def _errors_at(port: str) -> Iterator[None]:
    node = port.rpartition(".")[0]
    try:
        with watched(node):
            yield
    except ImagechainError as error:
        raise error.at(node) from error


@dataclass(frozen=True)
class _Source:
    """Samples before they are mapped: one picture's, or those of red, green and blue."""

    port: str
    value: Any
    recipes: tuple[Recipe, ...]
    facts: picture_facts.Facts
    signed: bool = False


def _recipes(bands: band_stack.BandStack, places: tuple[int, ...]) -> tuple[Recipe, ...]:
    """One band alone; of several all in one pass, as a file may have them sample by sample."""
    if len(places) == 1:
        return (bands.band(places[0]),)
    every = range(bands.count)
    sums = bands.sums(tuple(tuple(float(one == place) for one in every) for place in places))
    return tuple(Step.of(one_of, sums, index=index) for index in range(len(places)))


def _less(first: _Source, second: _Source) -> _Source:
    a, b = first.facts, second.facts
    if (a.rows, a.columns, a.kind) != (b.rows, b.columns, b.kind):
        raise DataError(
            f"cannot compute the difference: {first.port} is a {a.kind} of {a.columns} × {a.rows} "
            f"samples, {second.port} a {b.kind} of {b.columns} × {b.rows}"
        )
    if len(first.recipes) != len(second.recipes):
        of, without = sorted((first, second), key=lambda source: -len(source.recipes))
        raise DataError(
            f"cannot compute the difference: {of.port} is shown in colour from three bands, but "
            f"{without.port} has no bands"
        )
    if a.unit != b.unit:
        raise DataError(
            "cannot compute the difference: the units differ "
            f"({first.port}: {a.unit or 'none'}, {second.port}: {b.unit or 'none'})"
        )
    both = zip(first.recipes, second.recipes, strict=True)
    recipes = tuple(Step.of(difference, one, other) for one, other in both)
    facts = replace(a, band_um=None)  # the temperature of a difference means nothing
    return replace(first, recipes=recipes, facts=facts, signed=True)


def why_not_compared(kept: picture_facts.Facts, now: picture_facts.Facts) -> str:
    """How A, kept, and B, now, differ so that no sample has its equal; else empty."""
    reasons = []
    if kept.kind != now.kind:
        reasons.append(f"A is a {kept.kind}, B a {now.kind}")
    if (kept.rows, kept.columns) != (now.rows, now.columns):
        reasons.append(f"A has {kept.columns} × {kept.rows} samples, B {now.columns} × {now.rows}")
    if kept.unit != now.unit:
        reasons.append(f"the units differ (A: {kept.unit or 'none'}, B: {now.unit or 'none'})")
    elif kept.quantity != now.quantity:
        reasons.append(f"A is {kept.quantity}, B {now.quantity}")
    elif kept.wavelengths_um != now.wavelengths_um:
        both = (_wavelengths(facts.wavelengths_um) for facts in (kept, now))
        reasons.append("A is {}, B {}".format(*both))
    return f"not compared: {'; '.join(reasons)}" if reasons else ""


def _wavelengths(wavelengths_um: tuple[float, ...]) -> str:
    shown = ", ".join(f"{wavelength:.5g}" for wavelength in wavelengths_um)
    return f"at {shown} µm" if shown else "all bands"


# Steps from what is on a wire to the samples that are shown, kept in the store like any other.


@ends_lineage
def centred_plane(work: Work, *, value: wires.SpectrumWire | wires.Transfer) -> Array:
    """Samples of a magnitude, phase or transfer function with zero frequency in the middle."""
    samples: Array = engine.realize(value, work)
    return np.asarray(np.fft.fftshift(real(work, samples)))


@ends_lineage
def centred_modulus(work: Work, image: Array) -> Array:
    """Modulus of the unnormalised spectrum of an image, zero frequency in the middle."""
    return np.asarray(np.fft.fftshift(np.abs(wires.spectrum(work, image))))


@ends_lineage
def real(_work: Work, samples: Array) -> Array:
    """The samples, or of complex ones the modulus."""
    return np.abs(samples) if np.iscomplexobj(samples) else samples


@ends_lineage
def difference(_work: Work, samples: Array, other: Array) -> Array:
    return np.asarray(samples - other)


@ends_lineage
def one_of(_work: Work, pictures: Array, *, index: int) -> Array:
    """One of several pictures that are made together."""
    return np.asarray(pictures[index])


@ends_lineage
def finite_spread(work: Work, samples: Array, *, name: str) -> picture_facts.Spread:
    """Extremes and histogram; a `DataError` if samples are not finite."""
    with np.errstate(invalid="ignore"):
        spread = picture_facts.spread_of(samples, for_each=work.for_each)
    if not (np.isfinite(spread.low) and np.isfinite(spread.high)):
        check_finite(samples, name)
    return spread


@ends_lineage
def inner_range(work: Work, samples: Array, whole: picture_facts.Spread) -> picture_facts.Range:
    """From the 0.5 % to the 99.5 % quantile; the extremes where these are equal."""
    low, high = picture_facts.quantiles(samples, whole, INNER, for_each=work.for_each)
    return (low, high) if high > low else (whole.low, whole.high)


@dataclass(frozen=True, eq=False)
class Layer:
    shown: NDArray[Any]  # shape (rows, columns): the samples as the probe shows them
    mapped: NDArray[Any]  # the same, or their logarithms
    spread: picture_facts.Spread  # extremes and histogram of the mapped ones
    recipe: Recipe  # recipe, spread_recipe: of the mapped samples and of their spread
    spread_recipe: Recipe
    signed: bool = False  # whether automatic levels put 0 in the middle
    # of a converter whose numbers the mapped samples are; None where they are something else
    bits: int | None = None

    def range_of(self, work: Work, levels: picture_facts.Levels) -> picture_facts.Range:
        if not isinstance(levels, str):
            return levels
        low, high = self.spread.low, self.spread.high
        if levels == "percentiles":
            low, high = work.value(Step.of(inner_range, self.recipe, self.spread_recipe))
        if self.signed:
            high = max(abs(low), abs(high))
            low = -high
        return picture_facts.between_ends(low, high, self.bits)

    def grey(self, work: Work, levels: picture_facts.Range) -> NDArray[np.uint8]:
        work.check()
        return picture_facts.grey_levels(self.mapped, *levels, for_each=work.for_each)


def composed(
    work: Work, layers: Sequence[Layer], levels: picture_facts.Levels, like: Sequence[Channel] = ()
) -> tuple[NDArray[np.uint8], picture_facts.Range, tuple[Channel, ...]]:
    """Layers as colours, (rows, columns, layers), each between automatic levels of its own.

    Where the levels are two numbers, they are shares of what lies between these. With `like`, each
    is between the levels of that channel, so that two pictures can be compared.
    """
    automatic: picture_facts.Automatic = levels if isinstance(levels, str) else "percentiles"
    shares = WHOLE if isinstance(levels, str) else levels
    colours, channels = [], []
    for number, layer in enumerate(layers):
        low, high = like[number].ends if like else layer.range_of(work, automatic)
        between = high - low
        black, white = (low + share * between for share in shares)
        colours.append(layer.grey(work, (black, white)))
        channels.append(Channel(layer.shown, _as_shares(layer.spread, low, between), (low, high)))
    return np.stack(colours, axis=-1), shares, tuple(channels)


def _as_shares(spread: picture_facts.Spread, low: float, between: float) -> picture_facts.Spread:
    if not between > 0.0:  # one value: in the middle
        return picture_facts.Spread(0.5, 0.5, spread.counts)
    low_share, high_share = ((end - low) / between for end in (spread.low, spread.high))
    return picture_facts.Spread(low_share, high_share, spread.counts)


RADIANCE_PER_UM = "W/m²/sr/µm"


def probe(picture: Picture, row: int, column: int) -> tuple[float, float | None]:
    """A sample, and its apparent temperature where it is a radiance in a known band."""
    facts = picture.facts
    value = float(picture.samples[row, column])
    temperature = None
    if facts.band_um is not None and is_radiance(facts.unit):
        temperature = apparent_temperature(value, facts.band_um)
    elif facts.band_um is not None and facts.width_um and facts.unit == RADIANCE_PER_UM:
        temperature = apparent_temperature(value * facts.width_um, facts.band_um)
    return value, temperature


def index_at(facts: picture_facts.Facts, x: float, y: float) -> tuple[int, int]:
    return round(facts.along.index(y)), round(facts.across.index(x))


def _place_text(facts: picture_facts.Facts, row: int, column: int) -> str:
    x, y = facts.across.at(column), facts.along.at(row)
    if facts.kind == "plane":
        text = f"{facts.across.label} {x:.4g}  {facts.along.label} {y:.4g} {facts.across.unit}"
    else:
        text = f"row {y:.10g}  column {x:.10g}"
    return signed(text)


def _value_text(picture: Picture, row: int, column: int) -> str:
    value, temperature_K = probe(picture, row, column)
    named = zip("RGB", picture.channels, strict=False)
    values = "  ".join(f"{name} {one.samples[row, column]:.5g}" for name, one in named)
    text = f"{values or format(value, '.6g')} {picture.facts.unit}".rstrip()
    if temperature_K is not None:
        text += f"  {temperature_K:.2f} K"
    return signed(text)


def facts_text(picture: Picture, query: PictureQuery, kept: str = "", way: str = "") -> str:
    facts = picture.facts
    parts = [f"{facts.columns} × {facts.rows}", facts.title]
    if picture.logarithmic:
        parts[1] = f"log₁₀ {parts[1]}"
    if facts.wavelengths_um:
        parts.append(bands_text(facts.wavelengths_um))
    if picture.other is not None and kept:
        parts.insert(0, f"left A ({kept}), right B (now)" if way == "wipe" else f"A ({kept})")
        bands = picture.other.facts.band_um, facts.band_um
        if bands[0] != bands[1]:
            parts.append(f"A in {_band(bands[0])}, B in {_band(bands[1])}")
    elif picture.other is not None:
        parts.insert(0, f"left {query.port}, right {query.other}")
    elif query.compares and query.mode == "difference":
        parts.insert(0, f"{query.port} − {query.other}")
    if picture.reduced > 1:
        parts.append(f"preview 1:{picture.reduced}")
    return " · ".join(parts)


def bands_text(wavelengths_um: tuple[float, ...]) -> str:
    if len(wavelengths_um) == 1:
        return f"at {wavelengths_um[0]:.4g} µm"
    named = zip(picture_facts.CHANNELS, wavelengths_um, strict=True)
    return ", ".join(f"{name} {wavelength:.4g}" for name, wavelength in named) + " µm"


def _band(band_um: tuple[float, float] | None) -> str:
    return "no band" if band_um is None else f"{band_um[0]:g} to {band_um[1]:g} µm"


def sample_text(
    picture: Picture | None, place: tuple[int, int] | None, *, kept: bool = False
) -> str:
    """The sample at a place; of a wipe, those of both sides, with `kept` A first."""
    if picture is None or place is None:
        return ""
    facts, (row, column), other = picture.facts, place, picture.other
    if not (0 <= row < facts.rows and 0 <= column < facts.columns):
        return ""
    where, own = f"{_place_text(facts, row, column)}:  ", _value_text(picture, row, column)
    if other is None:
        return where + own
    # The other half of a wipe is laid over all of the picture.
    its = (
        int((row + 0.5) * other.facts.rows / facts.rows),
        int((column + 0.5) * other.facts.columns / facts.columns),
    )
    if not kept:
        return f"{where}{own}  |  {_value_text(other, *its)}"
    text = f"{where}A {_value_text(other, *its)}  |  B {own}"
    now_K, then_K = probe(picture, row, column)[1], probe(other, *its)[1]
    if now_K is not None and then_K is not None:
        text += signed(f"  |  B - A {now_K - then_K:+.3f} K")
    return text
