"""How a module's parameters are grouped on its panel: under titles, on pages, under conditions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Offer:
    """Which choices of a parameter are offered, as buttons, by the value of another.

    A value that is not among them stays allowed, and is offered as long as it is set.

    Parameters
    ----------
    parameter : str
        The one whose choices they are.
    by : str
        The one whose value decides.
    choices : tuple of (value, tuple)
        The choices for each value of `by`; all for a value that is not there.
    """

    parameter: str
    by: str
    choices: tuple[tuple[Any, tuple[Any, ...]], ...]

    def of(self, value: Any, otherwise: tuple[Any, ...]) -> tuple[Any, ...]:
        """The choices at a value of `by`."""
        return next((choices for known, choices in self.choices if known == value), otherwise)


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

    def mentioned(self) -> tuple[str, ...]:
        """Every parameter that it names."""
        offer, condition = self.offer, self.shown_when
        further = () if offer is None else (offer.parameter, offer.by)
        return (*self.parameters, *further, *(() if condition is None else condition[:1]))


def complete(sections: tuple[Section, ...], parameters: Sequence[str]) -> tuple[Section, ...]:
    """The sections, and one more with the parameters that none of them has.

    Raises
    ------
    TypeError
        A section names what is no parameter, or a parameter stands in two places.
    """
    placed = Counter(name for section in sections for name in section.parameters)
    wrong = [name for section in sections for name in section.mentioned() if name not in parameters]
    wrong += [name for name, places in placed.items() if places > 1]
    if wrong:
        allowed = f"each of {', '.join(parameters)} once"
        raise TypeError(f"the sections of the panel name {', '.join(wrong)}; allowed: {allowed}")
    left = tuple(name for name in parameters if name not in placed)
    return (*sections, Section("", left)) if left else sections
