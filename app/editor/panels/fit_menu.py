"""What the menu of a number offers about fits: free it, or fix it again."""

from __future__ import annotations

from functools import partial

from PySide6.QtWidgets import QMenu

from app.editor.free_numbers import FreeNumber
from app.editor.session import Session

_ABOUT = (
    "A fit to a picture (the dock Fit) determines what is free; this holds while the network is "
    "open, and is not saved with it"
)


def add_fit_action(menu: QMenu, session: Session, node: str, parameter: str) -> None:
    """Offer to free a number that may lie between others, or to fix it."""
    declared = session.declared(node)
    known = declared.parameter(parameter) if declared is not None else None
    if known is None or known.kind != "number":
        return
    free = session.free.has(node, parameter)
    if not free and parameter in session.network.nodes[node].linked:
        return  # what it follows can be free
    menu.addSeparator()
    action = menu.addAction("Fix (no longer fitted)" if free else "Free for a fit")
    action.setObjectName("fix" if free else "free")
    action.setToolTip(_ABOUT)
    action.setStatusTip(_ABOUT)
    action.triggered.connect(partial(_switch, session, node, parameter))
    menu.setToolTipsVisible(True)


def _switch(session: Session, node: str, parameter: str, *_: object) -> None:
    if session.free.has(node, parameter):
        session.free.fix(node, parameter)
    else:
        session.free.put(FreeNumber(node, parameter))
