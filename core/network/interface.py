"""What a macro shows of its inside: ports and parameters, by the inner node they stand for."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from core.errors import NetworkError
from core.names import shown, thaw

INPUTS, OUTPUTS, PARAMETERS = "inputs", "outputs", "parameters"
FIELDS = (INPUTS, OUTPUTS, PARAMETERS)

End = tuple[str, str]
"""An inner node, and its port or parameter."""


@dataclass(frozen=True)
class Interface:
    """The ports and parameters of a macro, in the order they are shown.

    Parameters
    ----------
    inputs : mapping of str to tuple of End
        The inner inputs that each input feeds: several, where one wire went to all of them.
    outputs, parameters : mapping of str to End
        The inner output or parameter that each stands for.
    """

    inputs: Mapping[str, tuple[End, ...]] = field(default_factory=dict)
    outputs: Mapping[str, End] = field(default_factory=dict)
    parameters: Mapping[str, End] = field(default_factory=dict)

    def fields(self) -> dict[str, Any]:
        """As the macro in a network file has them; empty ones are left out."""
        inputs = {
            name: text(ends[0]) if len(ends) == 1 else [text(end) for end in ends]
            for name, ends in self.inputs.items()
        }
        outputs = {name: text(end) for name, end in self.outputs.items()}
        parameters = {name: text(end) for name, end in self.parameters.items()}
        both = zip(FIELDS, (inputs, outputs, parameters), strict=True)
        return {name: entries for name, entries in both if entries}

    def renamed(self, old: str, new: str) -> Interface:
        """With an inner node's new name."""

        def moved(end: End) -> End:
            return (new, end[1]) if end[0] == old else end

        return Interface(
            {name: tuple(map(moved, ends)) for name, ends in self.inputs.items()},
            {name: moved(end) for name, end in self.outputs.items()},
            {name: moved(end) for name, end in self.parameters.items()},
        )

    def without(self, gone: Iterable[str]) -> Interface:
        """Without what stands for these inner nodes."""
        names = set(gone)
        inputs = {
            name: tuple(end for end in ends if end[0] not in names)
            for name, ends in self.inputs.items()
        }
        return Interface(
            {name: ends for name, ends in inputs.items() if ends},
            {name: end for name, end in self.outputs.items() if end[0] not in names},
            {name: end for name, end in self.parameters.items() if end[0] not in names},
        )

    def with_parameters(self, parameters: Mapping[str, End]) -> Interface:
        """With these parameters in place of its own."""
        return replace(self, parameters=dict(parameters))


def text(end: End) -> str:
    """``NODE.NAME``."""
    return f"{end[0]}.{end[1]}"


def end_of(entry: str) -> End:
    """``NODE.NAME`` split at its last dot.

    Raises
    ------
    NetworkError
        If it is not of that form.
    """
    node, _, name = entry.rpartition(".")
    if not node or not name:
        raise NetworkError(f"{entry!r:.80} is not of the form NODE.NAME")
    return node, name


def interface_of(extra: Mapping[str, Any], where: str = "macro") -> Interface:
    """The interface among a macro's fields.

    Raises
    ------
    NetworkError
        If a field is not of the form a network file must have.
    """
    inputs = {}
    for name, entry in _entries(extra, INPUTS, where):
        several = entry if isinstance(entry, list) else [entry]
        if not several:
            raise NetworkError(f"{where}.{INPUTS}.{shown(name)} names no inner input")
        inputs[name] = tuple(_end(each, f"{where}.{INPUTS}.{shown(name)}") for each in several)
    outputs, parameters = (
        {name: _end(entry, f"{where}.{kind}.{shown(name)}") for name, entry in entries}
        for kind, entries in (
            (OUTPUTS, _entries(extra, OUTPUTS, where)),
            (PARAMETERS, _entries(extra, PARAMETERS, where)),
        )
    )
    return Interface(inputs, outputs, parameters)


def _entries(extra: Mapping[str, Any], kind: str, where: str) -> list[tuple[str, Any]]:
    entries = thaw(extra.get(kind, {}))
    if not isinstance(entries, dict):
        raise NetworkError(f"{where}.{kind} must be an object of names and NODE.NAME")
    for name in entries:
        if not name.strip() or any(mark in name for mark in ".=/") or not name.isprintable():
            raise NetworkError(
                f"{where}.{kind} has the name {name!r:.80}: it must not be blank, nor hold '.', "
                "'=', '/' or a control character"
            )
    return list(entries.items())


def _end(entry: Any, where: str) -> End:
    if not isinstance(entry, str):
        raise NetworkError(f"{where} must be a text, NODE.NAME, not {entry!r:.60}")
    try:
        return end_of(entry)
    except NetworkError as error:
        raise NetworkError(f"{where}: {error.message}") from None
