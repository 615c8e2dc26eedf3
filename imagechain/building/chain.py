"""Chains: opened or built, changed in place, run."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Literal

from app.run.output import find_output
from app.run.shipped import find_network, shipped_networks
from core.chain.engine import Engine, Plan, PlannedNode
from core.editing.fields import set_parameter
from core.editing.links import Rewire, refusal
from core.editing.macros.inside import Inside
from core.editing.nodes import Remove, Rename
from core.editing.operation import ABSENT, Operation
from core.editing.output_mark import SetOutput
from core.errors import ImagechainError, NetworkError, UsageError
from core.evaluation.policy import Policy
from core.modules.declaration import Declaration
from core.modules.library_type import local_key
from core.modules.parameters import Parameter
from core.names import close, shown
from core.network.file import format_network, load_network
from core.network.linked_values import resolved, with_values
from core.network.macro import declared_node, opened, path_of, step_inside
from core.network.network import Link, Network, Node
from core.network.validation import NetworkProblems, check_network, plain_network
from imagechain.building.chain_check import Check, checked
from imagechain.building.chain_node import ChainNode
from imagechain.building.chain_saving import saved
from imagechain.building.chain_wiring import added, node_name
from imagechain.common.notebook_html import block, table
from imagechain.common.plain_errors import plain_errors
from imagechain.parts.module_part import Part, file_value
from imagechain.results.chain_result import Result, RunOptions, run_plan
from nodes.input_output.held_samples import HeldSamples
from nodes.input_output.read_image import ReadImage
from nodes.library import standard_library

Precision = Literal["single", "double"]


class Chain:
    """A network of modules that can be changed and run.

    Changes are made in place; `with_` and `copy` give another chain. What has been computed is
    kept, and shared with copies, so that a run after a change repeats only what follows it.

    Parameters
    ----------
    name : str
        Title, for reports and files.
    seed : int
        Of the noise; the same seed gives the same noise, to the bit.
    description : str
        What it shows.
    """

    @plain_errors
    def __init__(self, name: str = "", *, seed: int = 0, description: str = "") -> None:
        network = Network(name=name, seed=seed, description=description)
        self._begin(network, Path.cwd(), Engine(standard_library()), {})

    def _begin(
        self, network: Network, folder: Path, engine: Engine, samples: Mapping[str, HeldSamples]
    ) -> None:
        self._network = network
        self._folder = folder
        self._engine = engine
        self._samples = dict(samples)
        self._order = list(network.nodes)

    # What it is

    @property
    def name(self) -> str:
        """Its title."""
        return self._network.name

    @name.setter
    def name(self, text: str) -> None:
        self._network = replace(self._network, name=text)

    @property
    def description(self) -> str:
        """What it shows."""
        return self._network.description

    @description.setter
    def description(self, text: str) -> None:
        self._network = replace(self._network, description=text)

    @property
    def seed(self) -> int:
        """Seed of the noise."""
        return self._network.seed

    @seed.setter
    def seed(self, seed: int) -> None:
        self._network = self._network.with_seed(seed)

    @property
    def folder(self) -> Path:
        """What file names of the chain are relative to."""
        return self._folder

    @property
    def network(self) -> Network:
        """The network as the engine has it; immutable."""
        return self._network

    @property
    def nodes(self) -> dict[str, ChainNode]:
        """The nodes by name."""
        return {name: ChainNode(self, name) for name in self._network.nodes}

    @property
    def links(self) -> list[tuple[str, str]]:
        """The wires, from ``NODE.PORT`` to ``NODE.PORT``."""
        return [(start, end) for start, end in (link.text() for link in self._network.links)]

    @plain_errors
    def __getitem__(self, name: str) -> ChainNode:
        self.raw_node(name)
        return ChainNode(self, name)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self._network.has(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._network.nodes)

    def __len__(self) -> int:
        return len(self._network.nodes)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self._network.nodes)

    # Values

    @plain_errors
    def set(self, parameter: str | Mapping[str, Any], value: Any = ABSENT) -> Chain:
        """Set a parameter, or several of them at once; gives the chain itself.

        Parameters
        ----------
        parameter : str or mapping
            ``"NODE.PARAMETER"``, or values by that.
        value
            The value in the parameter's own unit; an `Expression`, or a text that begins with
            ``=``, makes the parameter follow others. File names are relative to the current folder.

        Raises
        ------
        ImagechainError
            If there is no such parameter, or it does not take the value; nothing is changed then.
        """
        if isinstance(parameter, str):
            if value is ABSENT:
                raise UsageError(f"set({shown(parameter)!r}): give a value")
            parameter = {parameter: value}
        network, dropped = self._network, set()
        for place, wanted in parameter.items():
            node, _, name = place.rpartition(".")
            if not node:
                raise UsageError(f"{shown(place)} names no parameter: write NODE.PARAMETER")
            declared = self._declared(network, node)
            known = declared.parameter(name)
            if known is not None and known.kind == "path":
                wanted = self._own_path(wanted)  # noqa: PLW2901
                dropped.add(node)
            raw = file_value(declared, name, wanted, node=node)
            network = _inside(network, node, set_parameter(_last(network, node), name, raw))
        self._network = network
        for node in dropped:
            self._samples.pop(node, None)
        return self

    @plain_errors
    def get(self, parameter: str) -> Any:
        """The value of ``NODE.PARAMETER``; of an expression, what comes out of it."""
        node, _, name = parameter.rpartition(".")
        return self[node][name]

    @plain_errors
    def reset(self, parameter: str) -> Chain:
        """Leave ``NODE.PARAMETER`` at its default; gives the chain itself."""
        node, _, name = parameter.rpartition(".")
        file_value(self.declared(node), name, None, node=node)
        operation = set_parameter(_last(self._network, node), name, ABSENT)
        self._network = _inside(self._network, node, operation)
        return self

    @plain_errors
    def with_(
        self, parameters: Mapping[str, Any] | None = None, *, seed: int | None = None
    ) -> Chain:
        """Another chain with other values, as `set` takes them; this one stays as it is."""
        other = self.copy()
        other.set(parameters or {})
        if seed is not None:
            other.seed = seed
        return other

    def copy(self) -> Chain:
        """Another chain that is like this one."""
        other = object.__new__(Chain)
        other._begin(self._network, self._folder, self._engine, self._samples)
        other._order = list(self._order)
        return other

    __copy__ = copy

    def __deepcopy__(self, _: Any) -> Chain:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (self._network, self._folder, self._samples, self._order)

    # Nodes and wires

    @plain_errors
    def add(
        self,
        part: Part,
        *,
        name: str | None = None,
        after: str | ChainNode | None = None,
        wired: bool = True,
    ) -> ChainNode:
        """Add a module, wired to the chain with its context, magnitude and phase; gives its node.

        Parameters
        ----------
        part : Part
            Of `ic.modules`, or `ic.scene`.
        name : str, optional
            What the node is called; default its module's key, of an array ``scene``.
        after : str or ChainNode, optional
            The node to go on from; it comes between that and the one that follows. Default is the
            node added last whose value goes nowhere yet.
        wired : bool
            Whether wires are made at all.

        Raises
        ------
        ImagechainError
            If it fits nowhere, or the name is taken.
        """
        library = self._engine.library
        if part.module not in library:
            hint = close(part.module, library)
            raise NetworkError(f"there is no module {shown(part.module)}{hint}")
        before = after.name if isinstance(after, ChainNode) else after
        if before is not None:
            self._network.node(before)
        id_ = node_name(name, part.name or local_key(part.module), self._network)
        declared = declared_node(Node(id_, part.module), library)
        assert declared is not None
        paths = {p.name for p in declared.parameters if p.kind == "path"}
        params = {
            key: self._own_path(value) if key in paths else value
            for key, value in part.params.items()
        }
        node = Node(id_, part.module, params)
        self._network = added(
            self._network, library, node, order=self._order, after=before, wired=wired
        )
        self._order.append(id_)
        if part.samples is not None:
            self._samples[id_] = part.samples
        return ChainNode(self, id_)

    @plain_errors
    def link(self, start: str, end: str) -> Chain:
        """Wire an output to an input, both as ``NODE.PORT``; a wire it had there goes.

        Raises
        ------
        NetworkError
            If they do not fit, or the wire would close a circle.
        """
        link = Link.between(start, end)
        wrong = refusal(self._network, self._engine.library, link)
        if wrong is not None:
            raise NetworkError(wrong)
        self._network = Rewire(add=(link,)).apply(self._network)
        return self

    @plain_errors
    def unlink(self, start: str, end: str) -> Chain:
        """Take a wire away."""
        self._network = Rewire(remove=(Link.between(start, end),)).apply(self._network)
        return self

    @plain_errors
    def remove(self, name: str) -> Chain:
        """Take a node out, with its wires."""
        self._network = Remove((name,)).apply(self._network)
        self._order.remove(name)
        self._samples.pop(name, None)
        return self

    @plain_errors
    def rename(self, old: str, new: str) -> Chain:
        """Call a node by another name, wherever it is mentioned."""
        self._network = Rename(old, new).apply(self._network)
        self._order = [new if name == old else name for name in self._order]
        if old in self._samples:
            self._samples[new] = self._samples.pop(old)
        return self

    @property
    def final(self) -> str | None:
        """The picture that the chain delivers, ``NODE.PORT``; None where it cannot be known."""
        return find_output(self._plan(self._plain(None))).port

    @plain_errors
    def mark_final(self, node: str) -> Chain:
        """Take the picture of a node for the one that the chain delivers."""
        self._network = SetOutput((node,)).apply(self._network)
        return self

    # Running

    @plain_errors
    def run(
        self,
        *,
        precision: Precision = "single",
        tolerance: float | None = None,
        seed: int | None = None,
        frames: int | None = None,
        outputs: Sequence[str] | None = None,
        region: tuple[slice, slice] | None = None,
        memory: int | str | None = None,
        threads: int = 0,
    ) -> Result:
        """Compute the chain; what has not changed since an earlier run is not computed again.

        Parameters
        ----------
        precision : "single" or "double"
            Of pictures and spectra.
        tolerance : float, optional
            Error budget: stages that together change the picture by less than this share of its
            range are left out. Default is below rounding; 0 leaves out only what changes nothing.
        seed : int, optional
            Other noise than that of the chain's own seed.
        frames : int, optional
            So many frames of each picture, each with temporal noise of its own and the same fixed
            patterns: pictures then are (frames, rows, columns).
        outputs : sequence of str, optional
            Compute only these, ``NODE.PORT``; all else once the result is asked for it.
        region : (slice, slice), optional
            Rows and columns of the pictures to compute; they have the bits of the whole picture.
        memory : int or str, optional
            Bytes (or "2GB") that computed values may take beside the ones in use.
        threads : int
            0 takes as many as there are; results do not depend on it.

        Raises
        ------
        ImagechainError
            The first fault, as the command `imagechain run` has it.
        """
        network = self._plain(seed)
        options = RunOptions.of(
            Policy(precision, tolerance, threads), frames, outputs, region, memory
        )
        plan = self._plan(network)
        errors = plan.errors()
        if errors:
            raise NetworkProblems(errors)
        return run_plan(self._engine, plan, options)

    @plain_errors
    def check(self) -> Check:
        """What is wrong with the chain, and what its modules warn of, without computing it."""
        return checked(lambda: self._plan(self._plain(None)))

    # Files

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write the chain to a network file, which command and editor open.

        Scenes from arrays are written beside it, as ``NAME_NODE.npy``. From then on file names are
        relative to its folder.

        Raises
        ------
        FileError
            If a file cannot be written, or one of those beside it is another's.
        """
        target = Path(os.path.abspath(fspath(path)))  # noqa: PTH100  (links stay)
        self._network = saved(
            self._network, self._engine.library, self._folder, target, self._samples
        )
        self._folder = target.parent
        return Path(path)

    def to_json(self) -> str:
        """The text of the network file."""
        return format_network(self._network, library=self._engine.library)

    # For what belongs to a chain

    def raw_node(self, name: str) -> Node:
        """The node as the network has it; also one inside of a macro, ``MACRO/NODE``."""
        return _node(self._network, name)

    def declared(self, name: str) -> Declaration:
        """What a node's module declares."""
        return self._declared(self._network, name)

    def part(self, name: str) -> Part:
        """A node's module with what is set."""
        node = self.raw_node(name)
        return Part(node.module, node.params, self._samples.get(name))

    def value_of(self, node: str, parameter: Parameter) -> Any:
        """The value of a node's parameter as it enters a run."""
        given = resolved(self._network, library=self._engine.library).value(node, parameter.name)
        if given is None:
            given = self.raw_node(node).params.get(parameter.name)
        if given is None or isinstance(given, Mapping):
            return parameter.default if given is None else None
        return parameter.coerce(list(given) if isinstance(given, tuple) else given)

    def _declared(self, network: Network, name: str) -> Declaration:
        node = _node(network, name)
        declared = declared_node(node, self._engine.library)
        if declared is None:
            hint = close(node.module, self._engine.library)
            raise NetworkError(f"there is no module {shown(node.module)}{hint}", node=name)
        return declared

    def _own_path(self, value: Any) -> Any:
        """A file name given here, relative to the current folder, as the chain has it."""
        if not isinstance(value, str | PathLike) or not fspath(value):
            return value
        text = Path(fspath(value))
        if text.is_absolute() or Path.cwd() == self._folder:
            return text
        return Path.cwd() / text

    def _plain(self, seed: int | None) -> Network:
        """The network that is computed, checked."""
        network = self._network
        if not network.nodes:
            raise NetworkError("the chain has no nodes: add some")
        network = plain_network(network, library=self._engine.library)
        if seed is not None:
            network = network.with_seed(seed)
        check_network(network, library=self._engine.library)
        return network

    def _plan(self, network: Network) -> Plan:
        return self._engine.plan(network, folder=self._folder, held=self._held(network))

    def _held(self, network: Network) -> dict[str, PlannedNode]:
        """The scenes that come from arrays, planned."""
        if not self._samples:
            return {}
        valued = with_values(network, library=self._engine.library).network
        planned = {}
        for name, samples in self._samples.items():
            node = valued.nodes[name]
            try:
                module = ReadImage.build(node.params)
                assert isinstance(module, ReadImage)
                output = module.of_samples(samples, name)
                planned[name] = PlannedNode(node, module, {}, output._asdict(), output)
            except ImagechainError as error:
                planned[name] = PlannedNode(node, error=error.at(name))
        return planned

    def __repr__(self) -> str:
        from app.run.readout_tables import columns

        title = f"<Chain {shown(self.name) if self.name else ''}".rstrip()
        head = f"{title}: {len(self)} nodes, seed {self.seed}>"
        rows = [
            (f"  {name}", module, "← " + wires if wires else "")
            for name, module, wires in self._rows()
        ]
        return f"{head}\n{columns(rows)}" if rows else head

    def _rows(self) -> list[tuple[str, str, str]]:
        """Name, module's title and what comes in, of every node."""
        rows = []
        for name, node in self._network.nodes.items():
            declared = declared_node(node, self._engine.library)
            wires = ", ".join(link.text()[0] for link in self._network.links_into(name))
            rows.append((name, declared.title if declared else node.module, wires))
        return rows

    def _repr_html_(self) -> str:
        caption = f"{self.name or 'Chain'} (seed {self.seed})"
        return block(table(("node", "module", "takes"), self._rows(), caption=caption))


@plain_errors
def open(network: str | PathLike[str]) -> Chain:
    """Open a network file, or a shipped network by its name.

    Parameters
    ----------
    network : str or path
        A path, or a name of `networks()`. File names in it are relative to its own folder.

    Raises
    ------
    ImagechainError
        If there is no such network, or it is none.
    """
    engine = Engine(standard_library())
    place = find_network(fspath(network))
    document = load_network(place.path, library=engine.library, unfinished=True)
    chain = object.__new__(Chain)
    chain._begin(document, Path(os.path.abspath(place.folder)), engine, {})  # noqa: PTH100
    return chain


def networks() -> list[str]:
    """Names of the shipped networks."""
    return list(shipped_networks())


def _unpickled(
    network: Network, folder: Path, samples: Mapping[str, HeldSamples], order: list[str]
) -> Chain:
    chain = object.__new__(Chain)
    chain._begin(network, folder, Engine(standard_library()), samples)
    chain._order = order
    return chain


def _node(network: Network, name: str) -> Node:
    step = step_inside(network, name)
    while step is not None:
        macro, name = step
        network = opened(network.nodes[macro])
        step = step_inside(network, name)
    return network.node(name)


def _last(network: Network, name: str) -> str:
    """A node's own id, without the macros it lies in."""
    return path_of(network, name)[-1]


def _inside(network: Network, name: str, operation: Operation) -> Network:
    """Carry an operation on a node out where it lies."""
    for macro in reversed(path_of(network, name)[:-1]):
        operation = Inside(macro, operation)
    return operation.apply(network)
