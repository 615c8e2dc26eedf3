"""Texts of an image viewer: what is shown, and the sample under the cursor."""

from __future__ import annotations

from app.editor.viewers.pixels.band_choice import CHANNELS
from app.editor.viewers.pixels.picture_choices import Choices
from app.editor.viewers.pixels.picture_query import Picture
from app.editor.viewers.pixels.probing import (
    other_probe,
    place_text,
    probe,
    probe_text,
    value_text,
)


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
