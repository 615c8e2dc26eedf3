"""What a picture has at the cursor, also in words."""

from __future__ import annotations

from app.editor.viewers.pixels.picture_facts import CHANNELS, Choices, Facts
from app.editor.viewers.pixels.picture_query import Picture
from core.records import dataclass
from nodes.input_output.examine_image import apparent_temperature
from nodes.shared.context_defaults import is_radiance

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
    return round(facts.along.index(y)), round(facts.across.index(x))


def other_probe(picture: Picture, other: Picture, row: int, column: int) -> Probe:
    """The sample of the other half of a wipe, which is laid over all of the picture."""
    facts, its = picture.facts, other.facts
    row = int((row + 0.5) * its.rows / facts.rows)
    sample = probe(other, row, int((column + 0.5) * its.columns / facts.columns))
    assert sample is not None  # inside the one is inside the other
    return sample


def place_text(picture: Picture, sample: Probe) -> str:
    facts = picture.facts
    x, y = facts.across.at(sample.column), facts.along.at(sample.row)
    if facts.kind == "plane":
        text = f"{facts.across.label} {x:.4g}  {facts.along.label} {y:.4g} {facts.across.unit}"
    else:
        text = f"row {y:.10g}  column {x:.10g}"
    return text.replace("-", "\N{MINUS SIGN}")


def value_text(picture: Picture, sample: Probe) -> str:
    values = "  ".join(
        f"{name} {value:.5g}" for name, value in zip("RGB", sample.colours, strict=False)
    )
    text = f"{values or format(sample.value, '.6g')} {picture.facts.unit}".rstrip()
    if sample.temperature_K is not None:
        text += f"  {sample.temperature_K:.2f} K"
    return text.replace("-", "\N{MINUS SIGN}")


def probe_text(picture: Picture, sample: Probe) -> str:
    """Where, what, and how warm it seems."""
    return f"{place_text(picture, sample)}:  {value_text(picture, sample)}"


# Texts of an image viewer: what is shown, and the sample under the cursor.


def facts_text(picture: Picture, choices: Choices, kept: str = "", way: str = "") -> str:
    facts = picture.facts
    parts = [f"{facts.columns} × {facts.rows}", facts.title]
    if picture.logarithmic:
        parts[1] = f"log₁₀ {parts[1]}"
    if facts.wavelengths_um:
        parts.append(bands_text(facts.wavelengths_um))
    if picture.other is not None and kept:
        parts.insert(
            0, f"A {kept} on the left, B now on the right" if way == "wipe" else f"A {kept}"
        )
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
    if len(wavelengths_um) == 1:
        return f"at {wavelengths_um[0]:.4g} µm"
    named = zip(CHANNELS, wavelengths_um, strict=True)
    return ", ".join(f"{name} {wavelength:.4g}" for name, wavelength in named) + " µm"


def _band(band_um: tuple[float, float] | None) -> str:
    return "no band" if band_um is None else f"{band_um[0]:g} to {band_um[1]:g} µm"


def sample_text(
    picture: Picture | None, place: tuple[int, int] | None, *, kept: bool = False
) -> str:
    """The sample at a place; of a wipe, those of both sides, with `kept` A first."""
    if picture is None or place is None or (sample := probe(picture, *place)) is None:
        return ""
    if picture.other is None:
        return probe_text(picture, sample)
    other = other_probe(picture, picture.other, *place)
    if not kept:
        return f"{probe_text(picture, sample)}  |  {value_text(picture.other, other)}"
    text = f"{place_text(picture, sample)}:  A {value_text(picture.other, other)}"
    text += f"  |  B {value_text(picture, sample)}"
    if sample.temperature_K is not None and other.temperature_K is not None:
        difference_K = sample.temperature_K - other.temperature_K
        text += f"  |  B \N{MINUS SIGN} A {difference_K:+.3f} K".replace("-", "\N{MINUS SIGN}")
    return text
