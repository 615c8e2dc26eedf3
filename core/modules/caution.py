"""A finding that does not keep a network from running, but may make its figures wrong.

A module's method that warns returns a `Caution`, or None; or the recipe of one, where samples have
to be looked at. A check that fails itself keeps nothing from running either: that it failed stands
in the place of its finding.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from core.errors import Cancelled, ImagechainError
from core.evaluation.float_guard import plug_in_error, with_place
from core.evaluation.recipes import Recipe
from core.names import shown

if TYPE_CHECKING:
    from core.evaluation.work import Work


@dataclass(frozen=True)
class Caution:
    """What a module warns of.

    Parameters
    ----------
    message : str
        What disagrees, with the values, in one line.
    remedy : str
        What to do about it, or when it is well.
    node, check : str
        The node it stands on, and the module's method that found it; the engine fills them in.
    """

    message: str
    remedy: str
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
    try:
        result = method()
    except Cancelled:
        raise
    except ImagechainError as error:
        result = Caution(f"its check {check} was not possible: {error.message}", "mend that first")
    except Exception as error:  # a fault of the method alone: network and other checks are sound
        fault = plug_in_error(error, node)
        what = fault.message if fault else with_place(error)
        remedy = "not of the network; what it checks may be wrong or right"
        whose = "a fault of its package" if fault else "a fault of this program"
        result = Caution(f"its check {check} failed ({what})", f"{whose}, {remedy}")
    if isinstance(result, Recipe):
        return PendingCheck(node, check, result)
    return None if result is None else result.at(node, check)
