"""The layers of a picture: one, or red, green and blue, each between levels of its own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from app.editor.viewers.pixels import picture_steps as steps
from app.editor.viewers.pixels.grey_levels import BINS, Range, Spread, between_ends, grey_levels
from app.editor.viewers.pixels.picture_facts import Facts
from core.evaluation.recipes import Recipe, Step
from core.evaluation.work import Work

Automatic = Literal["extremes", "percentiles"]
LevelChoice = Automatic | Range
WHOLE: Range = (0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Layer:
    """Samples that become one colour, or all the greys."""

    shown: NDArray[Any]  # shape (rows, columns): the samples as the probe shows them
    mapped: NDArray[Any]  # the same, or their logarithms
    spread: Spread  # extremes and histogram of the mapped ones
    recipe: Recipe  # recipe, spread_recipe: of the mapped samples and of their spread
    spread_recipe: Recipe
    signed: bool = False  # whether automatic levels put 0 in the middle
    # of a converter whose numbers the mapped samples are; None where they are something else
    bits: int | None = None

    def range_of(self, work: Work, levels: LevelChoice) -> Range:
        """What becomes black and white."""
        if not isinstance(levels, str):
            return levels
        low, high = self.spread.low, self.spread.high
        if levels == "percentiles":
            low, high = work.value(Step.of(steps.inner_range, self.recipe, self.spread_recipe))
        if self.signed:
            high = max(abs(low), abs(high))
            low = -high
        return between_ends(low, high, self.bits)

    def grey(self, work: Work, levels: Range) -> NDArray[np.uint8]:
        """The mapped samples from black to white."""
        work.check()
        return grey_levels(self.mapped, *levels, for_each=work.for_each)


@dataclass(frozen=True, eq=False)
class Channel:
    """One colour of a picture composed of three bands."""

    samples: NDArray[Any]  # shape (rows, columns): its samples, not mapped
    # extremes and histogram of the mapped samples, as shares of what lies between its automatic
    # levels: 0 at the lower one, 1 at the upper
    spread: Spread
    ends: Range  # these levels


def composed(
    work: Work, layers: Sequence[Layer], levels: LevelChoice, like: Sequence[Channel] = ()
) -> tuple[NDArray[np.uint8], Range, tuple[Channel, ...]]:
    """Layers as colours, (rows, columns, layers), each between automatic levels of its own.

    Where the levels are two numbers, they are shares of what lies between these. With `like`, each
    is between the levels of that channel, so that two pictures can be compared.
    """
    automatic: Automatic = levels if isinstance(levels, str) else "percentiles"
    shares = WHOLE if isinstance(levels, str) else levels
    colours, channels = [], []
    for number, layer in enumerate(layers):
        low, high = like[number].ends if like else layer.range_of(work, automatic)
        between = high - low
        black, white = (low + share * between for share in shares)
        colours.append(layer.grey(work, (black, white)))
        channels.append(Channel(layer.shown, _as_shares(layer.spread, low, between), (low, high)))
    return np.stack(colours, axis=-1), shares, tuple(channels)


def together(spreads: Sequence[Spread]) -> Spread:
    """Several spreads as one, in bins from the least of all to the greatest."""
    low, high = min(one.low for one in spreads), max(one.high for one in spreads)
    counts = np.zeros(BINS, np.int64)
    for one in spreads:
        place = np.zeros(BINS, np.intp)
        if high > low:
            place = np.minimum((one.centres - low) / (high - low) * BINS, BINS - 1).astype(np.intp)
        np.add.at(counts, place, one.counts)
    return Spread(low, high, counts)


def _as_shares(spread: Spread, low: float, between: float) -> Spread:
    if not between > 0.0:  # one value: in the middle
        return Spread(0.5, 0.5, spread.counts)
    low_share, high_share = ((end - low) / between for end in (spread.low, spread.high))
    return Spread(low_share, high_share, spread.counts)


# A picture of an earlier state of the network, and whether the present one compares with it.


@dataclass(frozen=True, eq=False)
class KeptPicture:
    """What was on a wire in an earlier state. Its arrays are read-only, and shared, not copied."""

    port: str  # ``NODE.PORT``
    value: Any  # what was on the wire
    samples: NDArray[Any]  # shape (rows, columns): the samples, not mapped
    facts: Facts  # what they are
    spread: Spread  # their extremes and histogram


def why_not_compared(kept: Facts, now: Facts) -> str:
    """In what the pictures of A, kept, and B, now, differ so that no sample has its equal.

    Empty where they can be laid over one another.
    """
    reasons = []
    if kept.kind != now.kind:
        reasons.append(f"A is a {kept.kind}, B a {now.kind}")
    if (kept.rows, kept.columns) != (now.rows, now.columns):
        reasons.append(f"A has {kept.columns} × {kept.rows} samples, B {now.columns} × {now.rows}")
    if kept.unit != now.unit:
        reasons.append(f"A is in {kept.unit or 'no unit'}, B in {now.unit or 'no unit'}")
    elif kept.quantity != now.quantity:
        reasons.append(f"A is {kept.quantity}, B {now.quantity}")
    elif kept.wavelengths_um != now.wavelengths_um:
        both = (_wavelengths(facts.wavelengths_um) for facts in (kept, now))
        reasons.append("A is {}, B {}".format(*both))
    return f"not compared: {'; '.join(reasons)}" if reasons else ""


def _wavelengths(wavelengths_um: tuple[float, ...]) -> str:
    shown = ", ".join(f"{wavelength:.5g}" for wavelength in wavelengths_um)
    return f"at {shown} µm" if shown else "all bands"
