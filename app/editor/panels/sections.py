"""How a panel's parameters are grouped under titles and on pages."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from core.modules.declaration import Declaration


@dataclass(frozen=True)
class Offer:
    """Which choices of a parameter are offered, as buttons, by the value of another.

    A value that is not among them stays allowed, and is offered as long as it is set.

    Parameters
    ----------
    parameter : str
        The one whose choices they are.
    by : str
        The one that tells which.
    choices : mapping of value to tuple
        The choices by the value of `by`; all for a value that is not there.
    """

    parameter: str
    by: str
    choices: Mapping[Any, tuple[Any, ...]]


@dataclass(frozen=True)
class Section:
    """Parameters that stand together on a panel.

    Parameters
    ----------
    title : str
        Stands above them; may be empty.
    parameters : tuple of str
        Their names, in order.
    page : str
        Sections of one page are shown together, and one page at a time; empty: always shown.
    shown_when : (str, tuple), optional
        A parameter, and those of its values for which the section is shown.
    offer : Offer, optional
        Limits the choices of one of the parameters.
    """

    title: str
    parameters: tuple[str, ...]
    page: str = ""
    shown_when: tuple[str, tuple[Any, ...]] | None = None
    offer: Offer | None = None


def plain_layout(declaration: Declaration) -> tuple[Section, ...]:
    """All parameters in one section without title."""
    return (Section("", tuple(parameter.name for parameter in declaration.parameters)),)


def complete(sections: tuple[Section, ...], declaration: Declaration) -> tuple[Section, ...]:
    """The sections, and one more with the parameters that none of them has."""
    placed = {name for section in sections for name in section.parameters}
    left = tuple(p.name for p in declaration.parameters if p.name not in placed)
    return (*sections, Section("", left)) if left else sections
