"""A chain that is planned once and then makes a picture of each new frame of its scene."""

import itertools
import math
import threading
from collections.abc import Mapping, Sequence
from numbers import Integral
from typing import Any

import numpy as np

from app.run.evaluation import refuse_faults, way_of_running
from app.run.own_scene import EIGHT_BITS, OwnScene, fitted, grey, sample_ends, with_own_scene
from app.run.transfer_chain import ancestors, find_output
from core.chain.engine import Engine, Plan, asked_for
from core.chain.random_fields import at_frame
from core.chain.wires import Image
from core.errors import DataError, NetworkError, ParameterError, UsageError, placed
from core.evaluation.work import Policy, Work
from core.machine import usable_bytes
from core.network.linked_values import with_values
from core.records import replace
from imagechain.building.chain_state import ChainState, planned_scene
from imagechain.parts.plain_errors import plain_errors
from nodes.files.formats import check_finite
from nodes.input_output.source_file import HeldSamples
from nodes.library import standard_library

_TOO_LARGE = (
    "size = {}: the pictures are too large for memory; use Chain.run, which computes them in blocks"
)


class Camera:
    """A chain as a function: ``camera(frame)`` runs the chain with the frame as its scene.

    Create a camera with `Chain.camera`. Only the requested outputs are computed. Results that all
    frames share are kept from the second frame on; all other results are discarded after each
    frame. A camera can be sent to other processes.
    """

    def __init__(
        self,
        state: ChainState,
        size: tuple[int, int],
        outputs: str | Sequence[str] | None,
        policy: Policy,
        scene: Mapping[str, Any],
        engine: Engine | None = None,
    ) -> None:
        self._made_of = state, size, outputs, policy, scene
        planner = Engine(standard_library()) if engine is None else engine
        self._policy, self._size, self._unit = policy, _checked_size(size), scene.get("unit", "")
        words = {name: value for name, value in scene.items() if name != "node"}
        usable = usable_bytes()
        if usable is not None and 4 * math.prod(self._size) > usable:
            raise UsageError(_TOO_LARGE.format(size))
        own = OwnScene(np.zeros(self._size, np.float32), **words)
        replaced = with_own_scene(
            state.network, own, library=planner.library, plan=state.plan(planner),
            node=scene.get("node"), engine=planner,
        )  # fmt: skip
        self._scene, self._ends = replaced.node, replaced.ends
        assert replaced.samples is not None
        samples = {**state.samples, replaced.node: replaced.samples}
        plan = replace(state, network=replaced.network, samples=samples).plan(planner)
        self._several = outputs is not None and not isinstance(outputs, str)
        self._ports = _ports(plan, outputs)
        nodes = [plan.network.port_names.get(port, port).rpartition(".")[0] for port in self._ports]
        needed = {*nodes, *ancestors(plan.network, *nodes), self._scene}
        network = with_values(plan.network, library=planner.library).network
        self._network = replace(
            network,
            nodes={name: node for name, node in network.nodes.items() if name in needed},
            links=tuple(link for link in network.links if link.target in needed),
        )
        self._held = {name: plan.nodes[name] for name in samples if name in needed}
        self._engine = Engine(planner.library)
        self._plan = self._engine.plan(self._network, folder=plan.folder, held=self._held)
        refuse_faults(self._plan)
        if way_of_running(self._plan, policy, None).in_blocks:
            raise UsageError(_TOO_LARGE.format(size))
        self._asked: set[str] = set()
        self._count, self._lock = itertools.count(), threading.Lock()

    def __reduce__(self) -> tuple[Any, ...]:
        return Camera, self._made_of

    @plain_errors
    def __call__(self, frame: Any, *, seed: int | None = None, number: int = 0) -> Any:
        """Return the picture of a frame, read-only; several outputs are returned as a dictionary.

        Parameters
        ----------
        frame : array
            The scene's samples, (rows, columns), or (rows, columns, 3) in colour, as
            `Chain.replace_scene` takes them.
        seed : int, optional
            Seed of all noise, fixed patterns included; by default the chain's own.
        number : int
            Number of the frame in a sequence, from 0. Each frame has its own temporal noise, and
            all frames have the same fixed patterns, as in ``run(frames=…)``.
        """
        if not (isinstance(number, Integral) and int(number) >= 0):
            raise ParameterError("number", number, "a whole number, 0 or more")
        with self._lock:
            plan = self._planned(frame, seed)
            work = self._engine.work(self._policy)
            values = {port: plan.output(port) for port in self._ports}
            recipes = [recipe for value in values.values() for recipe in asked_for(value)]
            try:
                with work.hold(recipes):
                    made = {port: self._made(plan, port, work, int(number)) for port in values}
            finally:
                # What this frame and the one before it asked for is kept; all else of either goes.
                asked = set(work.log.requested)
                work.forget(asked ^ self._asked)
                self._asked = asked
        return made if self._several else made[self._ports[0]]

    def _planned(self, frame: Any, seed: int | None) -> Plan:
        """The chain planned on a frame; all that hangs on neither it nor the seed stays."""
        held = self._samples(frame)
        node = self._network.nodes[self._scene]
        if self._ends is not None:
            eight_bits = getattr(frame, "dtype", None) == np.uint8
            levels = EIGHT_BITS if eight_bits else sample_ends(held.samples)
            node = replace(node, params={**node.params, **fitted(levels, self._ends)})
        network = self._network.with_node(node)
        self._plan = self._engine.plan(
            network if seed is None else network.with_seed(seed),
            folder=self._plan.folder,
            previous=self._plan,
            held={**self._held, self._scene: planned_scene(node, held)},
        )
        return refuse_faults(self._plan)

    def _samples(self, frame: Any) -> HeldSamples:
        unit = getattr(frame, "attrs", {}).get("units", self._unit)
        if unit != self._unit:
            raise UsageError(
                f"the frame is in {unit}, but the camera takes frames in {self._unit}: make the "
                f"camera with unit={unit!r}"
            )
        array = grey(np.asarray(frame))
        if array.shape != self._size:
            shape, size = (" × ".join(map(str, one)) for one in (array.shape, self._size))
            raise DataError(f"the frame has {shape} samples: the camera takes frames of {size}")
        held = HeldSamples.of(array, "the frame")
        vars(held)["key"] = f"frame {next(self._count)}"  # not shared: its content needs no hash
        return held

    def _made(self, plan: Plan, port: str, work: Work, number: int) -> Any:
        value = plan.output(port)
        with placed(port.rpartition(".")[0]):
            if not isinstance(value, Image):
                return self._engine.value(plan, port, work)
            samples = work.value(at_frame(value.recipe, number) if number else value.recipe)
            check_finite(samples, port)
            return samples

    def __repr__(self) -> str:
        rows, columns = self._size
        return f"<Camera: frames of {rows} × {columns} to {', '.join(self._ports)}>"


def _checked_size(size: Any) -> tuple[int, int]:
    try:
        rows, columns = size
    except (TypeError, ValueError):
        rows = columns = None
    if not all(isinstance(side, Integral) and int(side) >= 1 for side in (rows, columns)):
        raise ParameterError("size", size, "two whole numbers, 1 or more, for rows and columns")
    return int(rows), int(columns)


def _ports(plan: Plan, outputs: str | Sequence[str] | None) -> tuple[str, ...]:
    if outputs is None:
        final = find_output(plan)
        if final.port is None:
            hint = ": name the pictures, as outputs='NODE.PORT'" if final.choices else ""
            raise NetworkError(f"{final.missing}{hint}")
        return (final.port,)
    ports = (outputs,) if isinstance(outputs, str) else tuple(outputs)
    if not ports:
        raise ParameterError("outputs", outputs, "at least one NODE.PORT")
    for port in ports:
        plan.output(port)
    return ports
