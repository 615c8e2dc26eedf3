"""The immutable state of a chain (its network, arrays and folder), its plans and its nodes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np

from app.run import own_scene, terminal
from core.chain.engine import Engine, Plan, PlannedNode
from core.editing.document import rebased
from core.editing.operations import ABSENT, Operation, add_nodes, fresh_name, rewire, set_parameter
from core.editing.wiring import declared, outputs_of, wires_behind, wires_from_open_end
from core.errors import FileError, ImagechainError, NetworkError, ParameterError, UsageError, shown
from core.evaluation.recipes import Step
from core.modules.declaration import Declaration, Library, local_key, no_module
from core.modules.parameters import Caution, Parameter
from core.network import linked_values, macro, validation
from core.network.file import save_network
from core.network.network import Link, Network, Node, reached
from core.records import dataclass, field, replace
from imagechain.parts.module_part import Part, file_value, known_parameter, shown_value
from imagechain.parts.plain_errors import block, table
from imagechain.results.chain_result import current_folder
from nodes.files import arrays, frames
from nodes.input_output import read_image, sample_unit, source_file
from nodes.library import standard_library


@dataclass(frozen=True)
class ChainState:
    """A chain at one moment.

    File names are relative to `folder`; `file` is the network file that the chain was read from or
    last saved to. `samples` holds the scenes from arrays, by node; `given` lists the nodes and
    parameters whose file names were given in Python; `scene` describes how the scene's picture was
    interpreted.
    """

    network: Network
    folder: Path
    file: Path | None = None
    samples: Mapping[str, source_file.HeldSamples] = field(default_factory=dict)
    given: frozenset[tuple[str, str]] = frozenset()
    scene: tuple[str, ...] = ()

    def node(self, name: str) -> Node:
        """The node in the network; inside a macro, ``MACRO/NODE``."""
        return macro.unfolded(self.network).node(name)

    def declared(self, name: str) -> Declaration:
        """Declaration of a node's module."""
        node, library = self.node(name), standard_library()
        declared = macro.declared_node(node, library)
        if declared is None:
            raise NetworkError(no_module(node.module, library), node=name)
        return declared

    def value(self, name: str, parameter: Parameter) -> Any:
        """The value that a run uses for a node's parameter; None if there is no value."""
        resolved = linked_values.resolved(self.network, library=standard_library())
        given = resolved.value(name, parameter.name)
        if given is None:
            given = self.node(name).params.get(parameter.name)
        if given is None or isinstance(given, Mapping):
            return parameter.default if given is None else None
        try:
            return parameter.coerce(list(given) if isinstance(given, tuple) else given)
        except ParameterError:  # the check of the chain reports it
            return given

    def with_values(self, values: Mapping[str, Any]) -> ChainState:
        """Return the state with parameters set, by ``NODE.PARAMETER``; ABSENT means the default."""
        state = self
        for place, value in values.items():
            node, _, name = place.rpartition(".")
            if not node:
                raise UsageError(f"{shown(place)} is not a parameter: write NODE.PARAMETER")
            state = state._with_value(node, name, value)
        return state

    def _with_value(self, node: str, name: str, value: Any) -> ChainState:
        declared = self.declared(node)
        known = declared.parameter(name)
        samples, given = dict(self.samples), self.given
        if known is not None and known.kind == "path":
            value = self._own_path(value)
            given |= {(node, name)}
            if name == "path":
                samples.pop(node, None)
        raw = file_value(declared, name, None if value is ABSENT else value, node=node)
        state = self.done(set_parameter(node, name, ABSENT if value is ABSENT else raw))
        return replace(state, samples=samples, given=given)

    def done(self, operation: Operation) -> ChainState:
        """Return the state after an operation on the network; arrays follow their nodes."""
        moved = operation.moved(self.network)
        network = operation.apply(self.network)
        samples = {moved.get(node, node): held for node, held in self.samples.items()}
        given = ((moved.get(node, node), parameter) for node, parameter in self.given)
        return replace(
            self,
            network=network,
            samples={node: held for node, held in samples.items() if network.has(node)},
            given=frozenset(place for place in given if network.has(place[0])),
        )

    def with_part(
        self, part: Part, *, name: str | None, after: str | None, wired: bool
    ) -> tuple[str, ChainState]:
        """The name of a new node, and the state with this node; arguments as for `Chain.add`."""
        library = standard_library()
        if part.inside is None and part.module not in library:
            raise NetworkError(no_module(part.module, library))
        if after is not None:
            self.network.node(after)
        id_ = name
        if id_ is None:
            id_ = fresh_name(part.name or local_key(part.module), self.network.nodes)
        elif id_ in self.network.nodes:
            raise NetworkError(f"there is already a node {shown(id_)}")
        declared = macro.declared_node(Node(id_, part.module, macro=part.inside), library)
        assert declared is not None
        paths = declared.path_names
        params = {
            key: fspath(self._own_path(value)) if key in paths and value is not None else value
            for key, value in part.params.items()
        }
        node = Node(id_, part.module, params, macro=part.inside)
        network = self._grown(node, declared, after) if wired else None
        if network is None:
            network = add_nodes(((node, None),)).apply(self.network)
        samples = dict(self.samples)
        if part.samples is not None:
            samples[id_] = part.samples
        return id_, replace(
            self,
            network=network,
            samples=samples,
            given=self.given | {(id_, path) for path in paths},
        )

    def _grown(self, node: Node, taken: Declaration, after: str | None) -> Network | None:
        """The network with a node added and wired; None where it begins something of its own."""
        if not self.network.nodes or (after is None and not taken.inputs):
            return None
        grown, library = add_nodes(((node, None),)).apply(self.network), standard_library()
        if after is not None:
            wiring = wires_behind(grown, library, after, node.id, branches=False)
        else:
            order = reversed(tuple(self.network.nodes))  # as they were added
            every = (wires_from_open_end(grown, library, one, node.id) for one in order)
            wiring = next((found for found in every if found is not None), None)
        if wiring is not None:
            return _completed(wiring.apply(grown), library, node.id)
        if not taken.inputs:
            return None
        kinds = " or ".join(dict.fromkeys(kind for port in taken.inputs for kind in port.types))
        where = f"{shown(after)} has" if after is not None else "the chain has"
        raise NetworkError(
            f"{shown(node.id)} ({taken.title}) takes {kinds}, but {where} no free output of "
            "that kind. Set after= to a node with such an output, or set wired=False and use link()"
        )

    def with_scene(self, own: own_scene.OwnScene, node: str | None, engine: Engine) -> ChainState:
        """Return the state with a picture as its scene; errors as for `with_own_scene`."""
        is_array = isinstance(own.picture, np.ndarray)
        stored = None if is_array else fspath(self._own_path(own.picture))
        new = own_scene.with_own_scene(
            self.network, own, library=engine.library, plan=self.plan(engine), node=node,
            stored=stored, engine=engine,
        )  # fmt: skip
        samples = {name: held for name, held in self.samples.items() if name != new.node}
        return replace(
            self,
            network=new.network,
            samples=samples if new.samples is None else {**samples, new.node: new.samples},
            given=self.given | {(new.node, "path")},
            scene=new.lines,
        )

    def saved(self, target: Path) -> ChainState:
        """Write a network file, with the arrays beside it; returns the new state."""
        library = standard_library()
        network = self.network
        try:
            own = target.read_text(encoding="utf-8")
        except (OSError, ValueError):  # there is none, or it is no network: it names no file
            own = ""
        names = {}
        for node, held in self.samples.items():
            suffix = ".npy" if held.wavelengths_um is None else ".img"
            names[node] = f"{target.stem}_{_PLAIN.sub('_', node)}{suffix}"
        for node, name in names.items():
            network = set_parameter(node, "path", ABSENT).apply(network)
            if (file := target.parent / name).exists() and f'"{name}"' not in own:
                raise FileError(
                    f"{file} already exists and does not belong to this chain: save the chain "
                    "under another name, or remove that file"
                )
        network = rebased(network, library, self.folder, target.parent, typed=self.given)
        for node, name in names.items():
            network = set_parameter(node, "path", name).apply(network)
        for node, name in names.items():
            unit = network.nodes[node].params.get("unit", sample_unit.DEFAULT_UNIT)
            _write(target.parent / name, self.samples[node], named=unit != sample_unit.DEFAULT_UNIT)
        save_network(network, target, library=library)
        return replace(self, network=network, folder=target.parent, file=target)

    def _own_path(self, value: Any) -> Any:
        """A file name given here, relative to the current folder, as the chain stores it."""
        if not isinstance(value, str | PathLike) or not fspath(value):
            return value
        path = Path(fspath(value))
        if path.is_absolute() or current_folder() == self.folder:
            return path
        return current_folder() / path

    def plan(self, engine: Engine, seed: int | None = None, previous: Plan | None = None) -> Plan:
        """Plan the network with its macros expanded; each node keeps its own errors.

        Everything unchanged since a `previous` plan is reused.
        """
        if not self.network.nodes:
            raise NetworkError("the chain has no nodes: add a module")
        library = engine.library
        network = validation.plain_network(self.network, library=library)
        if seed is not None:
            network = network.with_seed(seed)
        validation.check_network(network, library=library)
        held = self._held(network, library, {} if previous is None else previous.nodes)
        return engine.plan(network, folder=self.folder, held=held, previous=previous)

    def _held(
        self, network: Network, library: Library, known: Mapping[str, PlannedNode]
    ) -> dict[str, PlannedNode]:
        """The scenes that come from arrays, planned."""
        if not self.samples:
            return {}
        valued = linked_values.with_values(network, library=library).network
        planned = {}
        for name, samples in self.samples.items():
            node = valued.nodes[name]
            if node.disabled:
                continue
            earlier = known.get(name)
            if earlier is not None and earlier.node is node and _is_of(earlier, samples):
                planned[name] = earlier
                continue
            try:
                planned[name] = planned_scene(node, samples)
            except ImagechainError as error:
                planned[name] = PlannedNode(node, error=error.at(name))
        return planned


def planned_scene(node: Node, samples: source_file.HeldSamples) -> PlannedNode:
    """A node that reads a picture, planned with an array instead of its file."""
    module = read_image.ReadImage.build(node.params)
    assert isinstance(module, read_image.ReadImage)
    output = module.of_samples(samples, node.id)
    return PlannedNode(node, module, {}, output._asdict(), output)


def _is_of(planned: PlannedNode, samples: source_file.HeldSamples) -> bool:
    recipe = getattr(planned.outputs.get("image"), "recipe", None)
    return isinstance(recipe, Step) and dict(recipe.parameters).get("held") is samples


# Wires of a new node beside the picture's.

_BESIDE = ("context", "pupil", "magnitude", "phase")


def _completed(network: Network, library: Library, name: str) -> Network:
    """With links for the inputs beside the picture that are still empty, from the nearest node."""
    known = declared(network, library, name)
    assert known is not None
    linked = {link.input for link in network.links_into(name)}
    behind = reached(network.followers, {name})
    place = {node: index for index, node in enumerate(network.nodes)}
    links = []
    for port in known.inputs:
        if port.name in linked or not port.required or port.types[0] not in _BESIDE:
            continue
        ends = [end for end in outputs_of(network, library, port.types[0]) if end[0] not in behind]
        if ends:
            nearest = max(ends, key=lambda end: place[end[0]])
            links.append(Link(*nearest, name, port.name))
    return rewire(add=tuple(links)).apply(network)


# What is wrong with a chain, without computing it.


@dataclass(frozen=True)
class Check:
    """Errors that keep a chain from running, and warnings that do not; one line each."""

    errors: tuple[ImagechainError, ...] = ()
    warnings: tuple[Caution, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether the chain can run."""
        return not self.errors

    def _rows(self) -> list[tuple[str, str]]:
        rows = [("error", str(error)) for error in self.errors]
        return rows + [("warning", str(warning)) for warning in self.warnings]

    def __str__(self) -> str:
        return "\n".join(map(": ".join, self._rows())) or "no errors, no warnings"

    __repr__ = __str__

    def _repr_html_(self) -> str:
        return block(table(("", "what"), self._rows() or [("", str(self))]))


_PLAIN = re.compile(r"[^\w.-]+")


def _write(file: Path, held: source_file.HeldSamples, *, named: bool) -> None:
    """Write samples: a picture as ``.npy``, a cube as ENVI has it, with its header beside it."""
    if held.wavelengths_um is None:
        arrays.write_npy(file, held.samples)
        return
    fields: dict[str, str | tuple[float, ...]] = {
        "wavelength_units": "Micrometers",
        "wavelength": held.wavelengths_um,
    }
    if not named:
        fields["unit"] = "W/m^2/sr/um"
    if held.widths_um is not None:
        fields["fwhm"] = held.widths_um
    dtype = held.samples.dtype.newbyteorder("<")
    bands, rows, columns = held.samples.shape
    series = frames.FrameSeries(bands, rows, columns, dtype, fields, "bands")
    frames.write_envi(file, series, held.samples)


# One node of a chain, with its parameters as attributes.


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
            raise AttributeError(f"{self._name} has no parameter {name!r}; its parameters: {names}")
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
                text += f" (= {linked_values.expression_text(raw)})"
            rows.append((parameter.name, text, parameter.param.unit, parameter.param.text))
        return rows

    def __repr__(self) -> str:
        head = f"<{self._name}: {self.title}>"
        rows = [("  " + name, value, unit) for name, value, unit, _ in self.rows()]
        return f"{head}\n{terminal.columns(rows)}" if rows else head

    def _repr_html_(self) -> str:
        heads = ("parameter", "value", "unit", "meaning")
        return table(heads, self.rows(), caption=f"{self._name}: {self.title}")
