"""Further frames of a sequence: the same picture with temporal noise of its own.

A frame differs from the picture in its noise streams alone, and not in those of a sensor's fixed
patterns, and in what is made of its number; all that leads to these keeps its key, so it is made
once for all frames.
"""

from collections.abc import Callable
from typing import Any, TypeVar

from core.chain.back_transformed import Delivered, DeliveredBands
from core.chain.band_stack import AttenuatedBands, BandStack, SteppedBands
from core.chain.random_fields import FrameNumber, Stream
from core.chain.wires import Magnitude, Phase
from core.evaluation.recipes import Recipe, Step, furthest_first
from core.records import replace
from core.transfer.factors import Law, Planar, Separable

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
            image = delivered.magnitude.image
            assert image is not None
            assert image.bands is not None
            return DeliveredBands.of(image.bands, delivered)
        if isinstance(bands, AttenuatedBands | SteppedBands):
            return replace(bands, before=self._bands(bands.before))
        return bands
