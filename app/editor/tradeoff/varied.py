"""The parameter that is varied: its present value, and setting it by hand."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from app.editor.declared_text import label_of
from app.editor.session import Session
from app.editor.tradeoff.ranges import Span
from app.run.output import ANALYSIS
from core.editing.operations import set_parameter
from core.errors import ParameterError
from core.modules.parameters import Parameter, plain
from core.names import thaw

_STEP = 0.01  # of the range, for an arrow key


class Varied:
    """A parameter of a node of the open document, or none.

    Parameters
    ----------
    session : Session
        The document, which edits go to.
    refuse : callable
        Called with the reason why a value is not allowed.
    """

    def __init__(self, session: Session, refuse: Callable[[str], None]) -> None:
        self.node, self.name = "", ""
        self._session = session
        self._refuse = refuse
        self._gesture: object | None = None

    @property
    def parameter(self) -> Parameter | None:
        """Its declaration; None where nothing is varied."""
        declared = self._session.declared(self.node)
        return declared.parameter(self.name) if declared is not None else None

    @property
    def analysis(self) -> str:
        """Its node where that is one of analysis, which the chain does not hang on; else empty."""
        declared = self._session.declared(self.node)
        return self.node if declared is not None and declared.group == ANALYSIS else ""

    @property
    def label(self) -> str:
        """Its name in words, and the unit."""
        parameter = self.parameter
        unit = parameter.param.unit if parameter is not None else ""
        return label_of(self.name) + (f" ({unit})" if unit else "")

    @property
    def present(self) -> Any:
        """Its value as it stands; None where it is empty or not allowed."""
        parameter, node = self.parameter, self._session.resolved.node(self.node)
        if parameter is None or node is None:
            return None
        if self.name not in node.params:
            return None if parameter.required else parameter.default
        try:
            return parameter.coerce(thaw(node.params[self.name]))
        except ParameterError:
            return None

    def choose(self, node: str = "", name: str = "") -> None:
        """Vary another one, or none."""
        self.release()
        self.node, self.name = node, name

    def move(self, value: float) -> None:
        """Set it; all until `release` is one step to undo."""
        parameter = self.parameter
        if parameter is None:
            return
        try:
            plain_value = plain(parameter.coerce(value))
        except ParameterError as error:
            self._refuse(error.message)
            return
        if plain_value is None or plain_value == self.present:
            return
        if why := self._session.follows(self.node, (self.name,)):
            self._refuse(why)
            return
        if self._gesture is None:
            self._gesture = object()
        self._session.do(set_parameter(self.node, self.name, plain_value), gesture=self._gesture)

    def step(self, span: Span, steps: int) -> None:
        """Move it by hundredths of a range, by one at least where it is whole."""
        present = self.present
        share = 0.0 if present is None else span.share(present)
        value = span.value_at(share + steps * _STEP)
        if span.whole and present is not None and value == present:
            value = min(max(present + steps, span.low), span.high)
        self.move(value)

    def release(self) -> None:
        """What follows is another step."""
        if self._gesture is not None:
            self._gesture = None
            self._session.end_gesture()
