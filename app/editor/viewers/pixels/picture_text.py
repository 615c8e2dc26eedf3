"""Texts of an image viewer: what is shown, and the sample under the cursor."""

from __future__ import annotations

from app.editor.viewers.pixels.picture_choices import Choices
from app.editor.viewers.pixels.picture_query import Picture
from app.editor.viewers.pixels.probing import probe, probe_text


def facts_text(picture: Picture, choices: Choices) -> str:
    """Size, quantity and unit, and what it is compared with."""
    facts = picture.facts
    parts = [f"{facts.columns} × {facts.rows}", facts.title]
    if picture.logarithmic:
        parts[1] = f"log₁₀ {parts[1]}"
    if picture.other is not None:
        parts.insert(0, f"left {choices.port}, right {choices.other}")
    elif choices.compares and choices.mode == "difference":
        parts.insert(0, f"{choices.port} − {choices.other}")
    if picture.reduced > 1:
        parts.append(f"preview 1:{picture.reduced}")
    return " · ".join(parts)


def sample_text(picture: Picture | None, place: tuple[int, int] | None, choices: Choices) -> str:
    """The sample at a row and column; of a wipe, those of both sides."""
    if picture is None or place is None or (sample := probe(picture, *place)) is None:
        return ""
    difference = choices.compares and choices.mode == "difference"
    text = probe_text(picture, sample, difference=difference)
    if picture.other is not None:
        facts, other = picture.facts, picture.other.facts
        row = int((place[0] + 0.5) * other.rows / facts.rows)
        column = int((place[1] + 0.5) * other.columns / facts.columns)
        value = float(picture.other.samples[row, column])
        text += f"  |  {value:.6g} {other.unit}".replace("-", "\N{MINUS SIGN}")
    return text
