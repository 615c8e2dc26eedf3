"""What a picture has at the cursor and along a line, also in words, and regions of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.editor.viewers.pixels.band_choice import CHANNELS
from app.editor.viewers.pixels.picture_choices import Choices
from app.editor.viewers.pixels.picture_facts import Facts
from app.editor.viewers.pixels.picture_query import Picture
from core.editing.operations import ABSENT, Operation, Together, set_parameter
from core.errors import ParameterError
from core.modules.declaration import Declaration
from core.names import thaw
from core.network.network import Node
from nodes.input_output.examine_image import apparent_temperature
from nodes.shared.shared_warnings import is_radiance

Vector = NDArray[np.float64]
Place = tuple[float, float]
RADIANCE_PER_UM = "W/m²/sr/µm"


@dataclass(frozen=True)
class Probe:
    row: int  # row, column: index into the samples, from 0
    column: int
    value: float  # the sample
    # the apparent temperature, where the sample is a radiance in a known band
    temperature_K: float | None = None
    colours: tuple[float, ...] = ()  # samples of red, green and blue, where it is composed of these


def probe(picture: Picture, row: int, column: int) -> Probe | None:
    """The sample at an index; None outside the picture."""
    facts = picture.facts
    if not (0 <= row < facts.rows and 0 <= column < facts.columns):
        return None
    value = float(picture.samples[row, column])
    temperature = None
    if facts.band_um is not None and is_radiance(facts.unit):
        temperature = apparent_temperature(value, facts.band_um)
    elif facts.band_um is not None and facts.width_um and facts.unit == RADIANCE_PER_UM:
        temperature = apparent_temperature(value * facts.width_um, facts.band_um)
    colours = tuple(float(channel.samples[row, column]) for channel in picture.channels)
    return Probe(row, column, value, temperature, colours)


def index_at(facts: Facts, x: float, y: float) -> tuple[int, int]:
    """Row and column of the sample nearest to a place on the axes."""
    return round(facts.along.index(y)), round(facts.across.index(x))


def other_probe(picture: Picture, other: Picture, row: int, column: int) -> Probe:
    """The sample of the other half of a wipe, which is laid over all of the picture."""
    facts, its = picture.facts, other.facts
    row = int((row + 0.5) * its.rows / facts.rows)
    sample = probe(other, row, int((column + 0.5) * its.columns / facts.columns))
    assert sample is not None  # inside the one is inside the other
    return sample


def place_text(picture: Picture, sample: Probe) -> str:
    """For people: where a sample lies."""
    facts = picture.facts
    x, y = facts.across.at(sample.column), facts.along.at(sample.row)
    if facts.kind == "plane":
        text = f"{facts.across.label} {x:.4g}  {facts.along.label} {y:.4g} {facts.across.unit}"
    else:
        text = f"row {y:.10g}  column {x:.10g}"
    return text.replace("-", "\N{MINUS SIGN}")


def value_text(picture: Picture, sample: Probe, *, difference: bool = False) -> str:
    """For people: what a sample is, and how warm it seems."""
    values = "  ".join(
        f"{name} {value:.5g}" for name, value in zip("RGB", sample.colours, strict=False)
    )
    text = f"{values or format(sample.value, '.6g')} {picture.facts.unit}".rstrip()
    if sample.temperature_K is not None and not difference:
        text += f"  {sample.temperature_K:.2f} K"
    return text.replace("-", "\N{MINUS SIGN}")


def probe_text(picture: Picture, sample: Probe, *, difference: bool = False) -> str:
    """For people: where, what, and how warm it seems.

    The temperature of a difference means nothing.
    """
    return f"{place_text(picture, sample)}:  {value_text(picture, sample, difference=difference)}"


# Texts of an image viewer: what is shown, and the sample under the cursor.


def facts_text(picture: Picture, choices: Choices, kept: str = "", way: str = "") -> str:
    """Size, quantity and unit, and what it is compared with: another wire, or what was kept."""
    facts = picture.facts
    parts = [f"{facts.columns} × {facts.rows}", facts.title]
    if picture.logarithmic:
        parts[1] = f"log₁₀ {parts[1]}"
    if facts.wavelengths_um:
        parts.append(bands_text(facts.wavelengths_um))
    if picture.other is not None and kept:
        parts.insert(0, f"left A {kept}, right B now" if way == "wipe" else f"A {kept}")
        bands = picture.other.facts.band_um, facts.band_um
        if bands[0] != bands[1]:
            parts.append(f"A in {_band(bands[0])}, B in {_band(bands[1])}")
    elif picture.other is not None:
        parts.insert(0, f"left {choices.port}, right {choices.other}")
    elif choices.compares and choices.mode == "difference":
        parts.insert(0, f"{choices.port} − {choices.other}")
    if picture.reduced > 1:
        parts.append(f"preview 1:{picture.reduced}")
    return " · ".join(parts)


def bands_text(wavelengths_um: tuple[float, ...]) -> str:
    """The bands that are shown alone or as colours, by their middles."""
    if len(wavelengths_um) == 1:
        return f"at {wavelengths_um[0]:.4g} µm"
    named = zip(CHANNELS, wavelengths_um, strict=True)
    return ", ".join(f"{name} {wavelength:.4g}" for name, wavelength in named) + " µm"


def _band(band_um: tuple[float, float] | None) -> str:
    return "no band" if band_um is None else f"{band_um[0]:g} to {band_um[1]:g} µm"


def sample_text(
    picture: Picture | None, place: tuple[int, int] | None, choices: Choices, *, kept: bool = False
) -> str:
    """The sample at a row and column; of a wipe, those of both sides.

    With `kept` the other one is A, from before, and stands first.
    """
    if picture is None or place is None or (sample := probe(picture, *place)) is None:
        return ""
    if picture.other is None:
        difference = choices.compares and choices.mode == "difference"
        return probe_text(picture, sample, difference=difference)
    other = other_probe(picture, picture.other, *place)
    if not kept:
        return f"{probe_text(picture, sample)}  |  {value_text(picture.other, other)}"
    text = f"{place_text(picture, sample)}:  A {value_text(picture.other, other)}"
    text += f"  |  B {value_text(picture, sample)}"
    if sample.temperature_K is not None and other.temperature_K is not None:
        difference_K = sample.temperature_K - other.temperature_K
        text += f"  |  B \N{MINUS SIGN} A {difference_K:+.3f} K".replace("-", "\N{MINUS SIGN}")
    return text


def along_line(samples: NDArray[Any], start: Place, end: Place) -> tuple[Vector, Vector]:
    """Samples along a line, bilinear between them, at steps of about one sample.

    Parameters
    ----------
    samples : ndarray, shape (rows, columns)
        The picture.
    start, end : (float, float)
        Column and row of the ends as fractional indices; what lies outside the picture is cut off.

    Returns
    -------
    distance, value : ndarray
        Distance from the start in samples; both empty if the line misses the picture.
    """
    (x0, y0), (x1, y1) = start, end
    length = math.hypot(x1 - x0, y1 - y0)
    share = np.linspace(0.0, 1.0, max(2, math.ceil(length) + 1))
    x, y = x0 + share * (x1 - x0), y0 + share * (y1 - y0)
    rows, columns = samples.shape
    inside = (x >= 0) & (x <= columns - 1) & (y >= 0) & (y <= rows - 1)
    x, y, distance = x[inside], y[inside], share[inside] * length
    left = np.clip(np.floor(x).astype(np.intp), 0, max(columns - 2, 0))
    top = np.clip(np.floor(y).astype(np.intp), 0, max(rows - 2, 0))
    right, below = np.minimum(left + 1, columns - 1), np.minimum(top + 1, rows - 1)
    tx, ty = x - left, y - top

    def at(row: NDArray[np.intp], column: NDArray[np.intp]) -> Vector:
        return np.asarray(samples[row, column], np.float64)

    upper = at(top, left) * (1 - tx) + at(top, right) * tx
    lower = at(below, left) * (1 - tx) + at(below, right) * tx
    return distance, upper * (1 - ty) + lower * ty


# The rectangle of samples that a module looks at: read from the document, moved, drawn.

PARAMETERS = ("region_x", "region_y", "region_width", "region_height")
Grip = tuple[int, int]
"""What of a rectangle is dragged: −1 its first edge, 1 its last, across and along; 0, 0 all."""
ALL: Grip = (0, 0)
Size = tuple[int, int]
"""Columns and rows of a picture."""


@dataclass(frozen=True)
class Region:
    """A rectangle of whole samples."""

    left: int
    top: int
    width: int
    height: int

    def description(self) -> str:
        return f"{self.width} × {self.height} at column {self.left}, row {self.top}"


def has_region(declared: Declaration | None) -> bool:
    """Whether a module has the parameters of a region."""
    return declared is not None and all(declared.parameter(name) for name in PARAMETERS)


def region_of(declared: Declaration, node: Node, size: Size) -> tuple[Region, bool]:
    """The document's region of a picture of that size, and whether it lies in the picture.

    The rectangle does in any case, and has a sample at least, so that it can be dragged.
    """
    x, y, width, height = (_value(declared, node, name) for name in PARAMETERS)
    left, across, fits_x = _within(x, width, size[0])
    top, along, fits_y = _within(y, height, size[1])
    return Region(left, top, across, along), fits_x and fits_y


def _within(first: int, length: int, whole: int) -> tuple[int, int, bool]:
    start = min(first, whole - 1)
    end = min(first + length, whole) if length else whole
    return start, max(end - start, 1), first < whole and first + length <= whole


def _value(declared: Declaration, node: Node, name: str) -> int:
    """A parameter's value, the default where it is none that is allowed; empty is 0."""
    parameter = declared.parameter(name)
    assert parameter is not None
    value: Any = parameter.default
    if name in node.params:
        try:
            value = parameter.coerce(thaw(node.params[name]))
        except ParameterError:
            value = parameter.default
    return value or 0


def setting(node: str, region: Region) -> Operation:
    values = (region.left, region.top, region.width, region.height)
    return _set(node, dict(zip(PARAMETERS, values, strict=True)))


def as_it_was(node: Node) -> Operation:
    """Give the node the region it has, also where it is left at the default."""
    return _set(node.id, {name: thaw(node.params.get(name, ABSENT)) for name in PARAMETERS})


def whole(node: str) -> Operation:
    """Make the region all of the node's picture."""
    return _set(node, dict.fromkeys(PARAMETERS, ABSENT))


def _set(node: str, values: dict[str, Any]) -> Operation:
    operations = [set_parameter(node, name, value) for name, value in values.items()]
    return Together(operations, f"Set {node}'s region")


def dragged(region: Region, grip: Grip, columns: int, rows: int, size: Size) -> Region:
    """The region with what the grip holds moved by so many samples, as far as the picture goes."""
    left, width = _moved(region.left, region.width, grip[0], grip == ALL, columns, size[0])
    top, height = _moved(region.top, region.height, grip[1], grip == ALL, rows, size[1])
    return Region(left, top, width, height)


def _moved(
    first: int, length: int, edge: int, everything: bool, by: int, whole: int
) -> tuple[int, int]:
    last = first + length
    if everything:
        return min(max(first + by, 0), whole - length), length
    if edge < 0:
        first = min(max(first + by, 0), last - 1)
    elif edge > 0:
        last = min(max(last + by, first + 1), whole)
    return first, last - first


def drawn(start: tuple[float, float], end: tuple[float, float], size: Size) -> Region:
    """The region between two corners, counted in samples from the picture's own first corner."""
    left, width = _between(start[0], end[0], size[0])
    top, height = _between(start[1], end[1], size[1])
    return Region(left, top, width, height)


def _between(one: float, other: float, whole: int) -> tuple[int, int]:
    low, high = sorted((one, other))
    first = min(max(round(low), 0), whole - 1)
    return first, max(min(round(high), whole) - first, 1)
