"""Undo and redo: what was done, with its inverse; edits of one gesture are one step."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import Any

from core.editing.fields import SetField
from core.editing.operation import ABSENT, Operation
from core.errors import NetworkError
from core.names import in_line
from core.network.network import EXPRESSION, Network

_LONGEST = 32  # letters of a value


@dataclass(frozen=True)
class Step:
    """One step of the history."""

    operation: Operation
    inverse: Operation

    @property
    def line(self) -> str:
        """What it did, in one line; of one value also what it was before and after."""
        match self.operation, self.inverse:
            case SetField(path=("nodes", _, "params", _)) as after, SetField() as before:
                values = f"{_value_text(before.value)} → {_value_text(after.value)}"
                return in_line(f"{self.operation.text}: {values}")
        return in_line(self.operation.text)


class History:
    """What was done to a document, up to where it stands and beyond what was undone."""

    def __init__(self) -> None:
        self._steps: list[Step] = []
        self._done = 0
        self._saved: int | None = 0
        self._gesture: Hashable = None
        self._start: Network | None = None

    @property
    def undo_text(self) -> str:
        """What undo would undo; empty where there is nothing."""
        return self._steps[self._done - 1].operation.text if self._done else ""

    @property
    def redo_text(self) -> str:
        """What redo would do again; empty where there is nothing."""
        return self._steps[self._done].operation.text if self._done < len(self._steps) else ""

    @property
    def modified(self) -> bool:
        """Whether the document differs from its saved state."""
        return self._saved != self._done

    @property
    def start(self) -> Network | None:
        """The network before the gesture that is going on, if one is."""
        return self._start

    @property
    def position(self) -> int:
        """How many steps are done."""
        return self._done

    @property
    def last(self) -> int:
        """The position after all steps, those included that were undone."""
        return len(self._steps)

    @property
    def saved(self) -> int | None:
        """The position that is saved; None where no step leads there."""
        return self._saved

    def line(self, position: int) -> str:
        """What the step did that leads to a position from the one before it; of 0 nothing."""
        return self._steps[position - 1].line if position else ""

    def mark_saved(self, saved: bool = True) -> None:
        """Record the present state as the saved one, or that no step leads to the saved one."""
        self._saved = self._done if saved else None
        self.end_gesture()

    def do(self, network: Network, operation: Operation, gesture: Hashable = None) -> Network:
        """Apply an operation and remember it; what was undone is forgotten.

        Operations in a row with the same `gesture` become one step.
        """
        after = operation.apply(network)
        undo = operation.inverse(network)
        del self._steps[self._done :]
        if self._saved is not None and self._saved > self._done:
            self._saved = None
        if gesture is not None and gesture == self._gesture:
            last = self._steps[-1]
            self._steps[-1] = Step(last.operation.then(operation), undo.then(last.inverse))
        else:
            self._steps.append(Step(operation, undo))
            self._done += 1
            self._start = network if gesture is not None else None
        self._gesture = gesture
        return after

    def forget(self) -> None:
        """Drop the step of the present gesture, which changed nothing in the end."""
        if self._gesture is not None:
            self._steps.pop()
            self._done -= 1
        self.end_gesture()

    def end_gesture(self) -> None:
        """What comes next is a step of its own."""
        self._gesture = self._start = None

    def undo(self, network: Network) -> Network:
        """The network before the last step; the same where there is none."""
        self.end_gesture()
        if not self._done:
            return network
        network = self._steps[self._done - 1].inverse.apply(network)
        self._done -= 1
        return network

    def go_to(self, network: Network, position: int) -> Network:
        """The network with so many steps done: the others undone, or done again.

        Raises
        ------
        NetworkError
            If there are not so many.
        """
        if not 0 <= position <= len(self._steps):
            raise NetworkError(
                f"the history has no position {position}: it goes from 0 to {len(self._steps)}"
            )
        self.end_gesture()
        while self._done > position:
            network = self.undo(network)
        while self._done < position:
            network = self.redo(network)
        return network

    def redo(self, network: Network) -> Network:
        """The network with the step done again that was undone last."""
        self.end_gesture()
        if self._done == len(self._steps):
            return network
        network = self._steps[self._done].operation.apply(network)
        self._done += 1
        return network


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
