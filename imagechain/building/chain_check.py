"""What is wrong with a chain, without computing it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from app.run.output import find_output
from core.chain.engine import Plan
from core.errors import ImagechainError
from core.modules.caution import Caution
from core.network.validation import NetworkProblems
from imagechain.common.notebook_html import block, table


@dataclass(frozen=True)
class Check:
    """Errors that keep a chain from running, and warnings that do not.

    Parameters
    ----------
    errors : tuple of ImagechainError
        One line each, with the node.
    warnings : tuple of Caution
        One line each, with what to do about it.
    """

    errors: tuple[ImagechainError, ...] = ()
    warnings: tuple[Caution, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the chain can run."""
        return not self.errors

    def __str__(self) -> str:
        lines = [f"error: {error}" for error in self.errors]
        lines += [f"warning: {warning}" for warning in self.warnings]
        return "\n".join(lines) or "no errors, no warnings"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        rows = [("error", str(error)) for error in self.errors]
        rows += [("warning", str(warning)) for warning in self.warnings]
        return block(table(("", "what"), rows or [("", str(self))]))


def checked(plan: Callable[[], Plan]) -> Check:
    """The faults of a network, or of its plan; `plan` raises those of the network itself."""
    try:
        made = plan()
        find_output(made)
    except NetworkProblems as faults:
        return Check(tuple(faults.problems))
    except ImagechainError as error:
        return Check((error,))
    return Check(tuple(made.errors()), tuple(made.warnings()))
