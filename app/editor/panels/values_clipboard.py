"""Copying the values of a node's panel, and pasting them on other nodes."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtGui import QGuiApplication

from app.editor.session import Session
from core.editing.clipboard import copied_values, pasted_values
from core.editing.operations import named
from core.errors import ImagechainError

_MOST_REASONS = 3


def copy_values(session: Session, names: Sequence[str]) -> None:
    """Put the values of the last of these nodes on the clipboard, as JSON text."""
    for name in names[-1:]:
        text = copied_values(session.network.nodes[name], session.declared(name))
        QGuiApplication.clipboard().setText(text)
        session.message.emit("note", f"copied the values of {name}")


def paste_values(session: Session, names: Sequence[str]) -> None:
    """Give nodes the clipboard's values, as one step; what is left out is said in one line."""
    try:
        pasted = pasted_values(
            QGuiApplication.clipboard().text(),
            names,
            session.network,
            declaration_of=session.declared,
            faults_after=session.link_faults,
        )
    except ImagechainError as error:
        session.message.emit("error", f"no values were pasted: {error}")
        return
    session.do(pasted.operation)
    number = len(pasted.taken)
    text = f"pasted {number} value{'' if number == 1 else 's'} on {named(names)}"
    if pasted.left_out:
        more = len(pasted.left_out) - _MOST_REASONS
        reasons = "; ".join(pasted.left_out[:_MOST_REASONS])
        text += f"; left out: {reasons}{f'; and {more} more' if more > 0 else ''}"
    session.message.emit("note", text)
