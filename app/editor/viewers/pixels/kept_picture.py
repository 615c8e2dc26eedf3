"""A picture of an earlier state of the network, and whether the present one compares with it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from app.editor.viewers.pixels.grey_levels import Spread
from app.editor.viewers.pixels.picture_facts import Facts


@dataclass(frozen=True, eq=False)
class KeptPicture:
    """What was on a wire in an earlier state. Its arrays are read-only, and shared, not copied.

    Parameters
    ----------
    port : str
        ``NODE.PORT``.
    value : object
        What was on the wire.
    samples : ndarray, shape (rows, columns)
        The samples, not mapped.
    facts : Facts
        What they are.
    spread : Spread
        Their extremes and histogram.
    """

    port: str
    value: Any
    samples: NDArray[Any]
    facts: Facts
    spread: Spread


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
