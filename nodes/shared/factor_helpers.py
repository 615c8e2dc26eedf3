"""Short ways to write factors of physics functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from core.transfer.factors import Law, Part, Planar, Separable


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
