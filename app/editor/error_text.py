"""Errors in the words of the window: the node's name and the panel's label, not the file's keys."""

from __future__ import annotations

from app.editor.declared_text import label_of
from core.errors import ImagechainError, ParameterError


def error_text(error: ImagechainError, *, on_node: bool = False) -> str:
    """The error in one line: ``σ y of blur = -1 mrad is not allowed: …``.

    Parameters
    ----------
    error : ImagechainError
        What is wrong.
    on_node : bool
        Whether the text stands on the node itself, which needs no name then.
    """
    text = error.message
    named = error.node is not None and not on_node
    if isinstance(error, ParameterError) and text.startswith(error.parameter):
        rest = text[len(error.parameter) :]
        return f"{label_of(error.parameter)}{f' of {error.node}' if named else ''}{rest}"
    return f"{error.node}: {text}" if named else text
