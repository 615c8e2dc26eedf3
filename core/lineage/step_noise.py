"""Noise where a step adds it: its name, whether it changes in time, its power."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from core.evaluation.recipes import Step
from core.evaluation.work import Work
from core.noise.noise_power import NoisePower

Array = NDArray[Any]
F = TypeVar("F", bound=Callable[..., Any])


def noises_in_blocks(function: F) -> F:
    """Mark a function of a step's noises that holds blocks alone of pictures on disk.

    Their power is one number, and variances of samples are made by `AtStep.by_rows`.
    """
    function.in_blocks = True  # type: ignore[attr-defined]
    return function


@dataclass(frozen=True)
class Noise:
    """A noise on its way: which node added it, whether it changes in time, and its power now.

    What becomes of a pattern that is known to the last sample is seen by making the picture with it
    alone: `pattern` is the step that adds it.
    """

    node: str
    name: str
    temporal: bool
    power: NoisePower
    pattern: Step | None = None


@dataclass(frozen=True)
class AtStep:
    """A step that adds noise, and the picture there.

    Parameters
    ----------
    work : Work
        Makes the values of inputs.
    step : Step
        The step itself.
    rows, columns : int
        Size of its picture.
    before : tuple of Noise
        What its picture has already.
    uniform : bool
        Whether gain errors are to be those of a uniform field of the picture's mean.
    filtered : bool
        Whether any noise is filtered on its way: what is not needs no sample's own variance.
    """

    work: Work
    step: Step
    rows: int
    columns: int
    before: tuple[Noise, ...]
    uniform: bool = False
    filtered: bool = True

    def by_rows(self, function: Callable[[Array], Array], picture: Array) -> Array:
        """Variances in double, each made of a picture's sample at its place; on disk as that is."""
        slabs = self.work.row_slabs(picture)
        if len(slabs) == 1:
            return np.asarray(function(picture), np.float64)
        made: Array = self.work.empty(picture.shape, np.dtype(np.float64))
        for rows in slabs:
            self.work.check()
            made[rows] = function(picture[rows])
        return made

    def white(self, name: str, variance: float | Array, *, temporal: bool = True) -> Noise:
        """Of independent samples, of one variance or each of its own."""
        power = NoisePower.white(self.rows, self.columns, variance)
        if not self.filtered:
            power = replace(power, variances=None)
        return self.coloured(name, power, temporal=temporal)

    def coloured(self, name: str, power: NoisePower, *, temporal: bool = True) -> Noise:
        """Of this power over the frame's waves."""
        return Noise(self.step.node or "", name, temporal, power)

    def known(self, name: str) -> Noise:
        """A pattern known to the last sample, the same in every frame."""
        none = NoisePower.white(self.rows, self.columns, 0.0)
        return Noise(self.step.node or "", name, False, none, self.step)
