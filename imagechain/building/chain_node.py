"""A node of a chain: its parameters to be read and set, with their units."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from core.errors import NetworkError
from core.modules.declaration import Declaration
from core.modules.parameters import Parameter
from core.network.linked_values import expression_text
from core.network.network import Node
from imagechain.parts.module_part import Part, known_parameter, shown_value
from imagechain.parts.plain_errors import table


class NodeOwner(Protocol):
    """What a node needs of its chain."""

    def set(self, parameter: str | Mapping[str, Any], value: Any = ...) -> object:
        """Set parameters."""

    def raw_node(self, name: str) -> Node:
        """The node as the network has it."""

    def declared(self, name: str) -> Declaration:
        """What its module declares."""

    def part(self, name: str) -> Part:
        """Its module with what is set."""

    def value_of(self, node: str, parameter: Parameter) -> Any:
        """The value of one of its parameters."""


class ChainNode:
    """One node of a chain; its parameters are attributes, read and set in their own units.

    ``chain["electronics"].amplifier_snr = 40`` is ``chain.set("electronics.amplifier_snr", 40)``.
    """

    _chain: NodeOwner
    _name: str

    def __init__(self, chain: NodeOwner, name: str) -> None:
        object.__setattr__(self, "_chain", chain)
        object.__setattr__(self, "_name", name)

    @property
    def name(self) -> str:
        """What the node is called in its chain."""
        return self._name

    @property
    def module(self) -> str:
        """Key of its module."""
        return self._chain.raw_node(self._name).module

    @property
    def title(self) -> str:
        """Title of its module; its key, where there is no such module."""
        known = self._known
        return self.module if known is None else known.title

    @property
    def inputs(self) -> tuple[str, ...]:
        """Its inputs, as ``NODE.PORT``."""
        return tuple(f"{self._name}.{port.name}" for port in self._declared.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Its outputs, as ``NODE.PORT``."""
        return tuple(f"{self._name}.{port.name}" for port in self._declared.outputs)

    @property
    def parameters(self) -> dict[str, Any]:
        """Values of all parameters by name, those of expressions as they come out."""
        return {p.name: self._value(p) for p in self._declared.parameters}

    @property
    def part(self) -> Part:
        """Its module with what is set, to be added to another chain."""
        return self._chain.part(self._name)

    def set(self, **values: Any) -> None:
        """Set parameters by name; all of them or, where one is refused, none."""
        self._chain.set({f"{self._name}.{name}": value for name, value in values.items()})

    def help(self) -> str:
        """What the module does, with its formula and source."""
        return self._declared.text

    @property
    def _declared(self) -> Declaration:
        return self._chain.declared(self._name)

    @property
    def _known(self) -> Declaration | None:
        """What its module declares; None where there is no such module."""
        try:
            return self._declared
        except NetworkError:
            return None

    def _value(self, parameter: Parameter) -> Any:
        return self._chain.value_of(self._name, parameter)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        parameter = self._declared.parameter(name)
        if parameter is None:
            names = ", ".join(p.name for p in self._declared.parameters) or "none"
            raise AttributeError(f"{self._name} has no parameter {name!r}: it has {names}")
        return self._value(parameter)

    def __setattr__(self, name: str, value: object) -> None:
        self._chain.set(f"{self._name}.{name}", value)

    def __getitem__(self, name: str) -> Any:
        return self._value(known_parameter(self._declared, name, None, node=self._name))

    def __setitem__(self, name: str, value: object) -> None:
        self._chain.set(f"{self._name}.{name}", value)

    def __dir__(self) -> list[str]:
        known = self._known
        parameters = () if known is None else known.parameters
        return sorted({*super().__dir__(), *(parameter.name for parameter in parameters)})

    def rows(self) -> list[tuple[str, str, str, str]]:
        """Name, value, unit and meaning of every parameter, as texts."""
        given: Mapping[str, Any] = self._chain.raw_node(self._name).params
        rows: list[tuple[str, str, str, str]] = []
        known = self._known
        if known is None:
            return [(name, shown_value(value), "", "") for name, value in given.items()]
        for parameter in known.parameters:
            text = shown_value(self._value(parameter))
            raw = given.get(parameter.name)
            if isinstance(raw, Mapping):
                text += f" (= {expression_text(raw)})"
            rows.append((parameter.name, text, parameter.param.unit, parameter.param.text))
        return rows

    def __repr__(self) -> str:
        from app.run.readout_tables import columns

        head = f"<{self._name}: {self.title}>"
        rows = [row[:3] for row in self.rows()]
        return (
            f"{head}\n{columns([('  ' + name, *rest) for name, *rest in rows])}" if rows else head
        )

    def _repr_html_(self) -> str:
        return table(
            ("parameter", "value", "unit", "meaning"),
            self.rows(),
            caption=f"{self._name}: {self.title}",
        )
