"""How a module's parameters are grouped on its panel: under titles, on pages, under conditions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from core.errors import Cancelled, ImagechainError
from core.evaluation.float_guard import plug_in_error, with_place
from core.names import shown

if TYPE_CHECKING:
    from core.evaluation.recipes import Recipe
    from core.evaluation.work import Work


@dataclass(frozen=True)
class Offer:
    """Which choices of a parameter are offered, as buttons, by the value of another.

    `choices` are those for each value of the parameter `by`; all for a value that is not there. A
    value that is not among them stays allowed, and is offered as long as it is set.
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

    Sections of one `page` are shown together, one page at a time; those without, always.
    """

    title: str  # stands above them; may be empty
    parameters: tuple[str, ...]  # their names, in order
    page: str = ""
    shown_when: tuple[str, tuple[Any, ...]] | None = None  # a parameter, and values of it
    offer: Offer | None = None  # limits the choices of one of the parameters

    def mentioned(self) -> tuple[str, ...]:
        """Every parameter that it names."""
        offer, condition = self.offer, self.shown_when
        further = () if offer is None else (offer.parameter, offer.by)
        return (*self.parameters, *further, *(() if condition is None else condition[:1]))


def complete(sections: tuple[Section, ...], parameters: Sequence[str]) -> tuple[Section, ...]:
    """The sections, and one more with the parameters that none of them has."""
    placed = Counter(name for section in sections for name in section.parameters)
    wrong = [name for section in sections for name in section.mentioned() if name not in parameters]
    wrong += [name for name, places in placed.items() if places > 1]
    if wrong:
        allowed = f"{', '.join(parameters)}, once each"
        raise TypeError(
            "unknown or repeated parameters in the panel's sections: "
            f"{', '.join(wrong)}; allowed: {allowed}"
        )
    left = tuple(name for name in parameters if name not in placed)
    return (*sections, Section("", left)) if left else sections


# A finding that does not keep a network from running, but may make its figures wrong.
#
# A module's method that warns returns a `Caution`, or None; or the recipe of one, where samples
# have to be looked at. A check that fails itself keeps nothing from running either: that it failed
# stands in the place of its finding.


@dataclass(frozen=True)
class Caution:
    """What a module warns of; the engine fills in the node, and the method that found it."""

    message: str  # what disagrees, with the values, in one line
    remedy: str  # what to do about it, or when it is well
    node: str = ""
    check: str = ""

    @property
    def text(self) -> str:
        """Warning and remedy in one line, without the node."""
        return f"{self.message}: {self.remedy}"

    def at(self, node: str, check: str) -> Caution:
        """The same, of that node."""
        return replace(self, node=node, check=check)

    def __str__(self) -> str:
        return f"{shown(self.node)}: {self.text}"


@dataclass(frozen=True)
class PendingCheck:
    """A warning of a node that takes samples: the recipe of a `Caution`, or of None."""

    node: str
    check: str
    recipe: Recipe

    def is_ready(self, work: Work) -> bool:
        """Whether the samples it takes have been computed."""
        return all(map(work.has, self.recipe.needs))

    def value(self, work: Work) -> Caution | None:
        """What it warns of."""
        result = checked(partial(work.value, self.recipe), node=self.node, check=self.check)
        return result if isinstance(result, Caution) else None


def checked(
    method: Callable[[], Caution | Recipe | None], *, node: str, check: str
) -> Caution | PendingCheck | None:
    """What a method warns of, placed on its node; a failure of its own is a `Caution` too."""
    from core.evaluation.recipes import Recipe  # numpy: who only reads declarations has no use

    try:
        result = method()
    except Cancelled:
        raise
    except ImagechainError as error:
        result = Caution(f"the check {check} could not run: {error.message}", "correct that first")
    except Exception as error:  # a fault of the method alone: network and other checks are sound
        fault = plug_in_error(error, node)
        what = fault.message if fault else with_place(error)
        remedy = "not in the network; the condition was not checked"
        whose = "an error in the module's package" if fault else "an error in this program"
        result = Caution(f"the check {check} failed ({what})", f"{whose}, {remedy}")
    if isinstance(result, Recipe):
        return PendingCheck(node, check, result)
    return None if result is None else result.at(node, check)
