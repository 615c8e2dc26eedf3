"""Matplotlib as the user's program has it, where the reports' own drawing is used."""

from __future__ import annotations


def users_matplotlib() -> None:
    """Import it with the user's settings, if it is not there yet.

    The reports would import it with their own, and the user's plots would have these afterwards.
    """
    import matplotlib  # noqa: F401
