"""Factors of transfer functions for modules: made, passed on, and put out."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from core.chain.step_lineage import lineage_of
from core.chain.wires import Image, Magnitude, Phase, Transfer
from core.transfer.factors import Factor, Grid, Law, Part, Planar, Separable
from nodes.shared.module_ports import Apply


def separable(
    function: Callable[..., Any],
    *,
    x: Mapping[str, Any] | None = None,
    y: Mapping[str, Any] | None = None,
    part: Part = "mtf",
    argument: str = "frequency",
    scale_x: float = 1.0,
    scale_y: float = 1.0,
    label: str = "",
    node: str | None = None,
) -> tuple[Separable, ...]:
    """A separable factor of one function with its parameters for each axis.

    None for an axis is the identity there; none for both gives no factor at all.
    """
    if x is None and y is None:
        return ()
    laws = [
        None if parameters is None else Law.of(function, scale=scale, **parameters)
        for parameters, scale in ((x, scale_x), (y, scale_y))
    ]
    return (Separable(laws[0], laws[1], part, argument, label=label, node=node),)


def radial(
    function: Callable[..., Any], *, label: str = "", node: str | None = None, **parameters: Any
) -> tuple[Planar, ...]:
    """A factor of the radial frequency alone."""
    return (Planar(Law.of(function, **parameters), radial=True, label=label, node=node),)


# Transfer factors that a picture has gone through already.


def passed_factors(image: Image) -> list[Factor]:
    """The factors on the way to a picture, those of the last step first."""
    here = Grid(*image.shape, image.interval_x_mrad or 1.0, image.interval_y_mrad or 1.0)
    recipe = image.recipe
    factors: list[Factor] = []
    while (lineage := lineage_of(recipe)) is not None and lineage.picture is not None:
        before = lineage.linear.grid_before(here)
        factors += lineage.linear.transfer(before, here, recipe.node)
        recipe, here = lineage.picture, before
    return factors


def transfers(factors: Sequence[Factor], image: Image, label: str) -> tuple[Transfer, Transfer]:
    """MTF and PTF of what filters a picture itself, to look at."""
    mtf, ptf = (
        Transfer(
            image.grid(),
            part,
            tuple(factor for factor in factors if factor.part == part),
            label=label,
            pixel_mrad=image.pixel_mrad,
        )
        for part in ("mtf", "ptf")
    )
    return mtf, ptf


# What a module with an OTF delivers: both halves of the spectrum, and the OTF to look at.


class OtfOutputs(NamedTuple):
    magnitude: Magnitude
    phase: Phase
    mtf: Transfer
    ptf: Transfer


def otf_outputs(
    apply: Apply,
    magnitude: Magnitude,
    phase: Phase | None,
    *,
    blur: Sequence[Factor],
    shift: Sequence[Factor] = (),
    label: str,
) -> OtfOutputs:
    """The spectrum times the OTF, or the OTF alone; a phase that is not linked begins here."""
    if phase is None:
        phase = Phase(None, magnitude.grid, magnitude.edges)
    mtf = magnitude.transfer("mtf", tuple(blur), label)
    ptf = magnitude.transfer("ptf", tuple(shift), label)
    if apply == "filter_only":
        return OtfOutputs(magnitude.only(*blur), phase.only(*shift), mtf, ptf)
    return OtfOutputs(magnitude.times(*blur), phase.plus(*shift), mtf, ptf)
