"""A formula of a module, for its page in the handbook."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Formula:
    """One line of what a module computes.

    Parameters
    ----------
    tex : str
        In TeX, of the part that matplotlib typesets.
    where : str
        What its symbols mean, with units.
    when : str
        For which choice of parameters it holds; empty: always.
    """

    tex: str
    where: str = ""
    when: str = ""
