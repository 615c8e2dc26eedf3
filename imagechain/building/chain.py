"""Open or build a chain, change it in place, and run it."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Literal

import numpy as np

from app.run import evaluation, own_scene, shipped, terminal, transfer_chain
from core.chain.engine import Engine, Plan
from core.editing import operations
from core.editing.wiring import refusal
from core.errors import ImagechainError, NetworkError, UsageError, several, shown
from core.evaluation.work import Policy
from core.network import file, macro, validation
from core.network.network import Link, Network
from core.records import replace
from imagechain.building.camera import Camera
from imagechain.building.chain_state import ChainNode, ChainState, Check
from imagechain.parts.module_part import Part
from imagechain.parts.plain_errors import block, plain_errors, table
from imagechain.results.chain_result import Result, RunOptions, current_folder, run_plan, whole_path
from nodes.library import standard_library

Precision = Literal["single", "double"]


class Chain:
    """A network of modules that you can change and run.

    Changes are made in place; `with_` and `copy` return another chain. Computed values are kept and
    shared with copies, so a run after a change computes only the values that depend on the change.

    Parameters
    ----------
    name : str
        Title, for reports and files.
    seed : int
        Seed of the noise; the same seed gives bit-identical noise.
    description : str
        Description of the chain, for reports and files.
    """

    @plain_errors
    def __init__(self, name: str = "", *, seed: int = 0, description: str = "") -> None:
        network = Network(name=name, seed=seed, description=description)
        self._engine = Engine(standard_library())
        self._state = ChainState(network, current_folder())
        self._planned: Plan | None = None

    @classmethod
    def _of(cls, state: ChainState, engine: Engine | None = None) -> Chain:
        chain = object.__new__(cls)
        chain._engine = Engine(standard_library()) if engine is None else engine
        chain._state, chain._planned = state, None
        return chain

    # What it is

    @property
    def name(self) -> str:
        """Title of the chain."""
        return self.network.name

    @name.setter
    @plain_errors
    def name(self, text: str) -> None:
        self._state = self._state.done(operations.set_network_field("name", text))

    @property
    def description(self) -> str:
        """Description of the chain."""
        return self.network.description

    @description.setter
    @plain_errors
    def description(self, text: str) -> None:
        self._state = self._state.done(operations.set_network_field("description", text))

    @property
    def seed(self) -> int:
        """Seed of the noise."""
        return self.network.seed

    @seed.setter
    @plain_errors
    def seed(self, seed: int) -> None:
        self._state = replace(self._state, network=self.network.with_seed(seed))

    @property
    def folder(self) -> Path:
        """Folder that the chain's file names are relative to."""
        return self._state.folder

    @property
    def network(self) -> Network:
        """The network that the engine computes; immutable."""
        return self._state.network

    @property
    def nodes(self) -> dict[str, ChainNode]:
        """The nodes by name."""
        return {name: ChainNode(self, name) for name in self.network.nodes}

    @property
    def links(self) -> list[tuple[str, str]]:
        """The wires, from ``NODE.PORT`` to ``NODE.PORT``."""
        return [(start, end) for start, end in (link.text() for link in self.network.links)]

    @plain_errors
    def __getitem__(self, name: str) -> ChainNode:
        self._state.node(name)
        return ChainNode(self, name)

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self.network.has(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self.network.nodes)

    def __len__(self) -> int:
        return len(self.network.nodes)

    def _ipython_key_completions_(self) -> list[str]:
        return list(self.network.nodes)

    # Values

    @plain_errors
    def set(self, parameter: str | Mapping[str, Any], value: Any = operations.ABSENT) -> Chain:
        """Set one parameter, or several at once; returns the chain itself.

        Parameters
        ----------
        parameter : str or mapping
            ``"NODE.PARAMETER"``, or a mapping of such names to values.
        value
            The value in the parameter's own unit; an `Expression`, or a string that begins with
            ``=``, makes the parameter follow other parameters. File names are relative to the
            current folder.
        """
        if isinstance(parameter, str):
            if value is operations.ABSENT:
                raise UsageError(f"set({shown(parameter)!r}): give a value")
            parameter = {parameter: value}
        if not isinstance(parameter, Mapping) or not all(isinstance(k, str) for k in parameter):
            raise UsageError(
                f"set({shown(repr(parameter))}): give NODE.PARAMETER as a string, "
                "or a mapping of such names to values"
            )
        self._state = self._state.with_values(parameter)
        return self

    @plain_errors
    def get(self, parameter: str) -> Any:
        """The value of ``NODE.PARAMETER``; an expression is evaluated."""
        node, _, name = parameter.rpartition(".")
        return self[node][name]

    @plain_errors
    def reset(self, parameter: str) -> Chain:
        """Reset ``NODE.PARAMETER`` to its default; returns the chain itself."""
        self._state = self._state.with_values({parameter: operations.ABSENT})
        return self

    @plain_errors
    def with_(
        self, parameters: Mapping[str, Any] | None = None, *, seed: int | None = None
    ) -> Chain:
        """Return a copy with the given values, as for `set`; this chain does not change."""
        other = self.copy()
        other.set(parameters or {})
        if seed is not None:
            other.seed = seed
        return other

    def copy(self) -> Chain:
        """Return an independent copy of the chain."""
        chain = Chain._of(self._state, self._engine)
        chain._planned = self._planned
        return chain

    __copy__ = copy

    def __deepcopy__(self, _: Any) -> Chain:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return Chain._of, (self._state,)

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
        """Add a module and wire its context, magnitude and phase; returns its node.

        Parameters
        ----------
        part : Part
            A module, as made by `ic.modules`, `ic.preset` or `ic.scene`.
        name : str, optional
            Name of the node; by default the module's key, or ``scene`` for an array.
        after : str or ChainNode, optional
            The node to continue from; the new node goes between this node and the one that follows.
            By default, the last added node with a free output.
        wired : bool
            Whether to wire the module.
        """
        if not isinstance(part, Part):
            raise UsageError(
                f"add({part!r:.80}): give a module, as from ic.modules.NAME(…) or ic.scene(…)"
            )
        before = after.name if isinstance(after, ChainNode) else after
        id_, self._state = self._state.with_part(part, name=name, after=before, wired=wired)
        return ChainNode(self, id_)

    @plain_errors
    def link(self, start: str, end: str) -> Chain:
        """Wire an output to an input, both as ``NODE.PORT``; replaces any wire to that input."""
        link = Link.between(start, end)
        wrong = refusal(self.network, self._engine.library, link)
        if wrong is not None:
            raise NetworkError(wrong)
        self._state = self._state.done(operations.rewire(add=(link,)))
        return self

    @plain_errors
    def unlink(self, start: str, end: str) -> Chain:
        """Remove a wire."""
        self._state = self._state.done(operations.rewire(remove=(Link.between(start, end),)))
        return self

    @plain_errors
    def remove(self, name: str) -> Chain:
        """Remove a node and its wires."""
        self._state = self._state.done(operations.remove_nodes((name,)))
        return self

    @plain_errors
    def rename(self, old: str, new: str) -> Chain:
        """Rename a node, also in wires and expressions; returns the chain itself."""
        self._state = self._state.done(operations.rename_node(old, new))
        return self

    @property
    def scene(self) -> tuple[str, ...]:
        """How your picture of the scene was interpreted, in words; empty if you gave no picture."""
        return self._state.scene

    @scene.setter
    @plain_errors
    def scene(self, picture: Any) -> None:
        self.replace_scene(picture)

    @plain_errors
    def replace_scene(
        self,
        picture: Any,
        *,
        node: str | None = None,
        fov_deg: tuple[float, float] | None = None,
        range_m: float | None = None,
        sample_m: float | None = None,
        band_um: tuple[float, float] | None = None,
        unit: str = "",
    ) -> Chain:
        """Replace the scene with your own picture; returns the chain itself.

        ``chain.scene = picture`` does the same without options. Anything you leave out is taken
        from the file or from the original scene; `chain.scene` lists the source of each value.

        Parameters
        ----------
        picture : path or array
            A file with a picture or cube, or an array: (rows, columns), or (rows, columns, 3)
            in colour.
        node : str, optional
            The node of the scene, if the chain has several.
        fov_deg : (float, float), optional
            Horizontal and vertical field of view, degrees.
        range_m : float, optional
            Distance to the scene, m.
        sample_m : float, optional
            Size of a sample on the scene, m, instead of the field of view.
        band_um : (float, float), optional
            Shortest and longest wavelength, µm.
        unit : str
            A unit of radiance, ``K``, ``C``, ``reflectance``, or ``relative``, which scales to the
            range of the original scene. By default, the unit in the file, else ``relative``.
        """
        is_file = isinstance(picture, str | PathLike)
        given = Path(fspath(picture)) if is_file else np.asarray(picture)
        unit = unit or getattr(picture, "attrs", {}).get("units", "")
        own = own_scene.OwnScene(given, fov_deg, range_m, sample_m, band_um, unit)
        self._state = self._state.with_scene(own, node, self._engine)
        return self

    @property
    @plain_errors
    def final(self) -> str | None:
        """Port of the final picture, ``NODE.PORT``; None if the port cannot be determined."""
        return transfer_chain.find_output(self._state.plan(self._engine)).port

    @plain_errors
    def mark_final(self, node: str) -> Chain:
        """Make the picture of a node the chain's final picture."""
        self._state = self._state.done(operations.mark_output((node,)))
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
        scratch: str | PathLike[str] | None = None,
        threads: int = 0,
    ) -> Result:
        """Compute the chain; values that have not changed since an earlier run are reused.

        Parameters
        ----------
        precision : "single" or "double"
            Precision of pictures and spectra.
        tolerance : float, optional
            Error budget: stages that together change the picture by less than this fraction
            of its range are left out. The default is below rounding error; 0 leaves out only
            stages without any effect.
        seed : int, optional
            Seed of the noise, instead of the chain's own.
        frames : int, optional
            Number of frames of each picture, each with its own temporal noise and the same fixed
            patterns. The shape of a picture is then (frames, rows, columns).
        outputs : sequence of str, optional
            Ports to compute, ``NODE.PORT``; all others are computed when you access them.
        region : (slice, slice), optional
            Rows and columns to compute in each picture; the samples are bit-identical to those of
            the whole picture.
        memory : int or str, optional
            Memory for pictures, in bytes or as a string such as "2GB"; by default half of the
            memory that the process may use. Larger pictures are computed in blocks, with
            bit-identical results, and kept on disk as memory-mapped arrays.
        scratch : path, optional
            Folder for memory-mapped arrays; by default the current folder. The files are deleted
            when the last array is released.
        threads : int
            Number of threads; 0 uses all cores. The number of threads does not affect the results.
        """
        policy, named = Policy(precision, tolerance, threads), {n for n, _ in self._state.given}
        what = (frames, outputs, region, memory, scratch)
        options = RunOptions(policy, *what, self._state.file, named)
        spare = [port.rpartition(".")[0] for port in options.outputs or ()]
        chain = self

        def smaller(error: ImagechainError) -> Plan:
            """Plan without the analyses that cannot use your scene, if they are the cause."""
            nonlocal chain
            library = self._engine.library
            while True:
                left = (
                    transfer_chain.without_judges(chain.network, error, library, spare)
                    if self.scene
                    else None
                )
                if left is None:
                    raise error
                for line in left[1]:
                    warnings.warn(line, stacklevel=4)
                chain = Chain._of(replace(chain._state, network=left[0]), self._engine)
                try:
                    return chain.planned(seed)[1]
                except ImagechainError as another:
                    error = another

        try:
            plan = self.planned(seed)[1]
        except ImagechainError as error:
            plan = smaller(error)
        return run_plan(self._engine, plan, options, smaller)

    @plain_errors
    def camera(
        self,
        size: tuple[int, int],
        *,
        outputs: str | Sequence[str] | None = None,
        precision: Precision = "single",
        tolerance: float | None = None,
        threads: int = 0,
        **scene: Any,
    ) -> Camera:
        """Plan the chain once for many frames; call the returned `Camera` with each frame.

        The picture is bit-identical to the picture from `run` with the frame as its scene. A camera
        gives no curves or read-outs.

        Parameters
        ----------
        size : (int, int)
            Rows and columns of the frames.
        outputs : str or sequence of str, optional
            Ports to compute, ``NODE.PORT``; with a sequence, each frame gives a dictionary. By
            default the final picture.
        precision, tolerance, threads
            As for `run`.
        **scene
            Known properties of the frames, as for `replace_scene`; for example ``unit="K"``.
        """
        policy = Policy(precision, tolerance, threads)
        return Camera(self._state, size, outputs, policy, scene, self._engine)

    @plain_errors
    def check(self) -> Check:
        """Errors and warnings of the chain, without computing it."""
        try:
            plan = self._state.plan(self._engine)
            transfer_chain.find_output(plan)
        except validation.NetworkProblems as faults:
            return Check(tuple(faults.problems))
        except ImagechainError as error:
            return Check((error,))
        return Check(tuple(plan.errors()), tuple(plan.warnings()))

    # Files

    @plain_errors
    def save(self, path: str | PathLike[str]) -> Path:
        """Write the chain to a network file that the command and the editor can open.

        Scenes from arrays are written beside the network file, as ``NAME_NODE.npy``; cubes are
        written as ``.img``. After saving, the chain's file names are relative to the folder of the
        network file.
        """
        self._state = self._state.saved(whole_path(path))
        return Path(fspath(path))

    def to_json(self) -> str:
        """The text of the network file."""
        return file.format_network(self.network, library=self._engine.library)

    def part(self, name: str) -> Part:
        """A node's module with its values and absolute file names, to add to another chain."""
        node = self._state.node(name)
        samples = self._state.samples.get(name)
        paths = self._state.declared(name).path_names
        params = {
            key: str((self.folder / value).absolute())
            if key in paths and isinstance(value, str) and value and samples is None
            else value
            for key, value in node.params.items()
        }
        return Part(node.module, params, samples, name, node.macro)

    def planned(self, seed: int | None = None) -> tuple[Engine, Plan]:
        """The engine and the chain's plan; raises an error if the plan contains errors."""
        self._planned = self._state.plan(self._engine, seed, self._planned)
        return self._engine, evaluation.refuse_faults(self._planned)

    def __repr__(self) -> str:
        title = f"<Chain {shown(self.name) if self.name else ''}".rstrip()
        head = f"{title}: {several(len(self), 'node')}, seed {self.seed}>"
        rows = [(f"  {name}", key, wires and f"← {wires}") for name, key, wires in self._rows()]
        return f"{head}\n{terminal.columns(rows)}" if rows else head

    def _rows(self) -> list[tuple[str, str, str]]:
        rows = []
        for name, node in self.network.nodes.items():
            declared = macro.declared_node(node, self._engine.library)
            wires = ", ".join(link.text()[0] for link in self.network.links_into(name))
            rows.append((name, declared.title if declared else node.module, wires))
        return rows

    def _repr_html_(self) -> str:
        caption = f"{self.name or 'Chain'} (seed {self.seed})"
        return block(table(("node", "module", "takes"), self._rows(), caption=caption))


@plain_errors
def open(network: str | PathLike[str]) -> Chain:
    """Open a network file, or an example network by its name.

    Parameters
    ----------
    network : str or path
        A path, or a name from `networks()`. File names in the network are relative to the network's
        folder.
    """
    engine = Engine(standard_library())
    place = shipped.find_network(fspath(network))
    document = file.load_network(
        place.path, library=engine.library, unfinished=True, keep_unknown=True
    )
    path = whole_path(place.path)
    return Chain._of(ChainState(document, path.parent, path), engine)


def networks() -> list[str]:
    """Names of the example networks."""
    return list(shipped.shipped_networks())
