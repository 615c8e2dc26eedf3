"""One node of a chain, with its parameters as attributes."""

from collections.abc import Mapping
from typing import Any

from app.run.readout_tables import columns
from core.errors import NetworkError
from core.modules.declaration import Declaration
from core.modules.parameters import Parameter
from core.network.linked_values import expression_text
from imagechain.building.chain_state import ChainState
from imagechain.parts.module_part import Part, known_parameter, shown_value
from imagechain.parts.plain_errors import table


class ChainNode:
    """One node of a chain; its parameters are attributes, read and set in their own units.

    ``chain["electronics"].amplifier_snr = 40`` is ``chain.set("electronics.amplifier_snr", 40)``.
    """

    _chain: Any
    _name: str

    def __init__(self, chain: Any, name: str) -> None:
        object.__setattr__(self, "_chain", chain)
        object.__setattr__(self, "_name", name)

    @property
    def name(self) -> str:
        """Name of the node in its chain."""
        return self._name

    @property
    def module(self) -> str:
        """Key of the node's module."""
        return self._state.node(self._name).module

    @property
    def title(self) -> str:
        """Title of the node's module; its key if the module is unknown."""
        known = self._known
        return self.module if known is None else known.title

    @property
    def inputs(self) -> tuple[str, ...]:
        """Inputs of the node, as ``NODE.PORT``."""
        return tuple(f"{self._name}.{port.name}" for port in self._declared.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        """Outputs of the node, as ``NODE.PORT``."""
        return tuple(f"{self._name}.{port.name}" for port in self._declared.outputs)

    @property
    def parameters(self) -> dict[str, Any]:
        """Values of all parameters by name; expressions are evaluated."""
        return {p.name: self._value(p) for p in self._declared.parameters}

    @property
    def part(self) -> Part:
        """The node's module with the values set on it, to add to another chain."""
        part: Part = self._chain.part(self._name)
        return part

    def set(self, **values: Any) -> None:
        """Set parameters by name; if any value is not allowed, no value is set."""
        self._chain.set({f"{self._name}.{name}": value for name, value in values.items()})

    def help(self) -> str:
        """Description of the module, with its formula and source."""
        return self._declared.text

    @property
    def _state(self) -> ChainState:
        state: ChainState = self._chain._state
        return state

    @property
    def _declared(self) -> Declaration:
        return self._state.declared(self._name)

    @property
    def _known(self) -> Declaration | None:
        try:
            return self._declared
        except NetworkError:
            return None

    def _value(self, parameter: Parameter) -> Any:
        return self._state.value(self._name, parameter)

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
        """Name, value, unit and meaning of every parameter, as strings."""
        given: Mapping[str, Any] = self._state.node(self._name).params
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
        head = f"<{self._name}: {self.title}>"
        rows = [("  " + name, value, unit) for name, value, unit, _ in self.rows()]
        return f"{head}\n{columns(rows)}" if rows else head

    def _repr_html_(self) -> str:
        return table(
            ("parameter", "value", "unit", "meaning"),
            self.rows(),
            caption=f"{self._name}: {self.title}",
        )
