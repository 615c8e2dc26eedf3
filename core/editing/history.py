"""Undo and redo: the networks a document has been; edits of one gesture are one step."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import Any

from core.editing.operations import ABSENT, Operation, SetField
from core.errors import NetworkError
from core.names import in_line, thaw
from core.network.network import EXPRESSION, Network

_LONGEST = 32  # letters of a value


@dataclass(frozen=True)
class State:
    """A network, what was done to come to it, and the path of the one field that this set."""

    network: Network
    text: str = ""
    field: tuple[str, ...] = ()


class History:
    """The states of a document, up to where it stands and beyond what was undone."""

    def __init__(self, network: Network) -> None:
        self._states = [State(network)]
        self._at = 0
        self.saved: int | None = 0
        """The position that is saved; None where no step leads there."""
        self._gesture: Hashable = None

    @property
    def network(self) -> Network:
        return self._states[self._at].network

    @property
    def start(self) -> Network | None:
        """The network before the gesture that is going on, if one is."""
        return self._states[self._at - 1].network if self._gesture is not None else None

    @property
    def undo_text(self) -> str:
        """What undo would undo; empty where there is nothing."""
        return self._states[self._at].text

    @property
    def redo_text(self) -> str:
        """What redo would do again; empty where there is nothing."""
        return self._states[self._at + 1].text if self._at < self.last else ""

    @property
    def modified(self) -> bool:
        """Whether the document differs from its saved state."""
        return self.saved != self._at

    @property
    def position(self) -> int:
        """How many steps are done."""
        return self._at

    @property
    def last(self) -> int:
        """The position after all steps, those included that were undone."""
        return len(self._states) - 1

    def line(self, position: int) -> str:
        """What the step did that leads to a position, in one line; of 0 nothing.

        Of one value also what it was before and after.
        """
        state = self._states[position]
        match state.field:
            case ("nodes", node, "params", name):
                values = [
                    _value_text(thaw(one.network.nodes[node].params.get(name, ABSENT)))
                    for one in self._states[position - 1 : position + 1]
                ]
                return in_line(f"{state.text}: {' → '.join(values)}")
        return in_line(state.text)

    def mark_saved(self, saved: bool = True) -> None:
        """Record the present state as the saved one, or that no step leads to the saved one."""
        self.saved = self._at if saved else None
        self.end_gesture()

    def add(self, network: Network, operation: Operation, gesture: Hashable = None) -> None:
        """Take the network after an operation; what was undone is forgotten.

        Operations in a row with the same `gesture` become one step.
        """
        del self._states[self._at + 1 :]
        if self.saved is not None and self.saved > self._at:
            self.saved = None
        field = operation.path if isinstance(operation, SetField) else ()
        state = State(network, operation.text, field)
        if gesture is not None and gesture == self._gesture:
            first = self._states.pop()
            if field != first.field or not field:
                state = State(network, first.text)
        self._states.append(state)
        self._at = self.last
        self._gesture = gesture

    def forget(self) -> None:
        """Drop the step of the present gesture, which changed nothing in the end."""
        self._states.pop()
        self._at -= 1
        self.end_gesture()

    def end_gesture(self) -> None:
        """What comes next is a step of its own."""
        self._gesture = None

    def go_to(self, position: int) -> None:
        """Stand where so many steps are done; a `NetworkError` if there are not so many."""
        if not 0 <= position <= self.last:
            raise NetworkError(
                f"the history has no position {position}: it goes from 0 to {self.last}"
            )
        self._at = position
        self.end_gesture()


def _value_text(value: Any) -> str:
    """A parameter's value as a network file has it, in a few letters."""
    if value is ABSENT:
        return "default"
    if isinstance(value, bool):
        return "on" if value else "off"
    if isinstance(value, Mapping) and EXPRESSION in value:
        text = f"= {value[EXPRESSION]}"
    elif isinstance(value, list | tuple):
        text = ", ".join(map(str, value)) or "none"
    else:
        text = str(value)
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 1]}…"
