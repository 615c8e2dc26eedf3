"""Failures of our own, as errors of one line."""

from __future__ import annotations

from core.errors import Cancelled, ImagechainError


class OwnFailure(ImagechainError):
    """The program has failed, not its input."""


def as_error(error: Exception, node: str | None = None) -> ImagechainError:
    """The error to show for whatever was raised; one of the project's own is kept.

    Parameters
    ----------
    error : Exception
        What was raised; `Cancelled` is for the caller to look after.
    node : str, optional
        The node it happened on.
    """
    if isinstance(error, ImagechainError) and not isinstance(error, Cancelled):
        return error
    if isinstance(error, MemoryError):
        text = "our own failure: not enough memory; make the picture smaller, or close other ones"
        return OwnFailure(text, node=node)
    reason = " ".join(str(error).split())[:200]
    return OwnFailure(f"our own failure: {type(error).__name__}: {reason}", node=node)
