"""What is timed and how: a subject and the bare Fourier round trip T0 in turn, median of ratios."""

import os
import platform
import statistics
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import scipy
import scipy.fft

from app.run import terminal
from app.run.shipped import find_network
from core.arrays import Array
from core.chain.engine import Engine, Plan
from core.errors import UsageError
from core.evaluation.recipes import Store
from core.evaluation.work import Policy, Precision
from core.machine import physical_bytes
from core.network.file import load_network
from core.network.network import Link, Network, Node
from core.records import dataclass
from core.transfer.periodic import backend
from nodes.library import standard_library

Seconds = Callable[[], float]
SIZE, LARGEST = 1024, 8192
# Every block a measurement frees would else go back to the system, and its pages be faulted in
# again by the next one: half of the time of a transform, at the kernel's whim.
STEADY = {
    "MALLOC_MMAP_THRESHOLD_": str(1 << 30),
    "MALLOC_TRIM_THRESHOLD_": str(1 << 32),
    "OPENBLAS_NUM_THREADS": "1",
}


@dataclass(frozen=True)
class Settings:
    """Samples along each side of the picture, and whether repetitions and sizes are fewer."""

    size: int = SIZE
    quick: bool = False

    def __post_init__(self) -> None:
        if not 32 <= self.size <= LARGEST or self.size % 4:
            raise UsageError(f"--size {self.size}: give a multiple of 4 from 32 to {LARGEST}")

    @property
    def pairs(self) -> int:
        """Repetitions of a subject, each beside a T0 of its own."""
        return 5 if self.quick else 15

    @property
    def slow_pairs(self) -> int:
        return 2 if self.quick else 5

    @property
    def small(self) -> int:
        """Size of a picture for comparisons with direct sums, which take size³ steps."""
        return min(self.size, 256) if self.quick else self.size


def seconds(function: Callable[[], object]) -> float:
    start = time.perf_counter()
    function()
    return time.perf_counter() - start


def round_trip(image: Array, workers: int) -> Seconds:
    """T0: a bare transform there and back of this image."""

    def trip() -> float:
        start = time.perf_counter()
        scipy.fft.irfft2(scipy.fft.rfft2(image, workers=workers), s=image.shape, workers=workers)
        return time.perf_counter() - start

    return trip


def paired(subject: Seconds, t0: Seconds, *, pairs: int, warm_up: int = 2) -> dict[str, Any]:
    """Columns of a table: medians over pairs measured in turn, and quartiles of their ratios.

    Both return their own seconds, so that preparations do not count. `alone_ms` is T0 back to
    back, with warm caches: how far T0 itself varies. The first `warm_up` pairs do not count.
    """
    for _ in range(warm_up):
        t0()
        subject()
    samples = [(t0(), subject()) for _ in range(pairs)]
    ratios = sorted(took / unit for unit, took in samples)
    low, middle, high = statistics.quantiles(ratios, n=4, method="inclusive")
    return {
        "t0": middle,
        "low": low,
        "high": high,
        "ms": 1e3 * statistics.median(took for _, took in samples),
        "t0_ms": 1e3 * statistics.median(unit for unit, _ in samples),
        "alone_ms": 1e3 * statistics.median(t0() for _ in range(pairs)),
        "pairs": pairs,
    }


def repeated(function: Callable[[], object], times: int) -> dict[str, float]:
    took = [seconds(function) for _ in range(times)]
    return {"seconds": statistics.median(took), "low": min(took), "high": max(took)}


def isolate() -> None:
    """Start this process again with `STEADY` in its environment, unless it has it already."""
    if any(name not in os.environ for name in STEADY):
        sys.stdout.flush()
        words = [sys.executable, *sys.orig_argv[1:]]
        os.execve(sys.executable, words, {**os.environ, **STEADY})


def environment() -> dict[str, str]:
    usual = {name: value for name, value in os.environ.items() if name not in STEADY}
    return terminal.environment(usual)


def machine_facts() -> dict[str, Any]:
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "usable_cores": len(os.sched_getaffinity(0)),
        "memory_bytes": physical_bytes() or 0,
        "load": os.getloadavg()[0],
        "system": platform.platform(),
        "fft": backend(),
        "versions": terminal.versions(),
    }


def machine_words(facts: Mapping[str, Any]) -> list[str]:
    return [
        facts["processor"],
        f"{facts['usable_cores']} of {facts['cores']} cores",
        f"{facts['memory_bytes'] / 2**30:.0f} GiB",
        f"load {facts['load']:.1f} at the start",
        *(f"{name} {release}" for name, release in facts["versions"].items()),
        f"transforms of periodic frames by {facts['fft']}",
    ]


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


SCENE = "scene.image"
KODAK = "kodak_kir310"
PIXELS, FINAL = "pixels.image", "frame_grabber.image"
SHIPPED_SIZE, GRABBER_LINES = 1024, 486
Nodes = Mapping[str, tuple[str, Mapping[str, Any]]]


class SceneStore(Store):
    """A store that keeps one value whatever happens: the picture a run starts with."""

    def __init__(self) -> None:
        super().__init__()
        self._held: dict[str, Any] = {}

    def hold(self, key: str, value: Any) -> None:
        self._held[key] = value

    def peek(self, key: str, default: Any = None) -> Any:
        held = self._held.get(key)
        return super().peek(key, default) if held is None else held

    def keys(self) -> set[str]:
        with self._lock:
            return set(self._values)

    def forget_all_but(self, keys: set[str]) -> None:
        for key in self.keys() - keys:
            self.drop(key)


class Chain:
    """An engine, a network and its scene; whatever is timed returns its own seconds."""

    def __init__(self, network: Network, policy: Policy, scene: Any = None) -> None:
        self.network = network
        self.policy = policy
        self.store = SceneStore()
        self.engine = Engine(standard_library(), self.store)
        self.work = self.engine.work(policy)
        self.scene = self.value(network, SCENE) if scene is None else scene.astype(policy.dtype)
        self._key = f"{self.engine.plan(network).output(SCENE).recipe.key}/{policy.key}"
        self.take(self.scene)
        self.store.clear()
        self._edits = 0
        self.t0 = round_trip(self.scene, policy.workers)

    def take(self, scene: Any) -> None:
        self.store.hold(self._key, scene)

    def value(self, network: Network, port: str) -> Any:
        return self.engine.value(self.engine.plan(network), port, self.work)

    def left_by(self, port: str) -> set[str]:
        """Keys of what a port's value leaves in an empty store."""
        self.store.clear()
        self.value(self.network, port)
        return self.store.keys()

    def cold(self, network: Network, port: str, readouts: tuple[str, ...] = ()) -> float:
        self.store.clear()
        start = time.perf_counter()
        plan = self.engine.plan(network)
        self.engine.value(plan, port, self.work)
        for node in readouts:
            self.engine.readouts(plan, node, self.work)
        return time.perf_counter() - start

    def edited(
        self, port: str, known: set[str], edit: tuple[str, str, tuple[Any, ...]] | None = None
    ) -> float:
        """Seconds to a port's value with what is `known`, of `left_by`, and all else forgotten."""
        self.store.forget_all_but(known)
        network = self.network
        if edit is not None:
            node, parameter, values = edit
            self._edits += 1
            value = values[self._edits % len(values)]
            network = network.with_parameter(node, parameter, value)
        return self.looked_at_again(port, self.engine.plan(self.network), network)

    def looked_at_again(self, port: str, before: Plan, network: Network) -> float:
        start = time.perf_counter()
        plan = self.engine.plan(network, previous=before)
        self.engine.value(plan, port, self.work)
        return time.perf_counter() - start


def kodak_chain(
    size: int, precision: Precision = "single", scene: Any = None, threads: int = 0
) -> Chain:
    """The Kodak KIR-310 network, its scene of `size`² samples."""
    return Chain(kodak_network(size), Policy(precision, threads=threads), scene)


def without_photons(network: Network) -> Network:
    return network.with_parameter("photons", "percent", 0.0)


def kodak_network(size: int) -> Network:
    """The shipped network at another size of its scene, its frame grabber in proportion."""
    network = load_network(find_network(KODAK).path, library=standard_library())
    lines = max(1, round(size * GRABBER_LINES / SHIPPED_SIZE))
    for node, width, height in (("scene", size, size), ("frame_grabber", size // 2, lines)):
        network = network.with_parameter(node, "width", width)
        network = network.with_parameter(node, "height", height)
    return network


def sensor_network(
    scene: tuple[str, Mapping[str, Any]],
    init: Mapping[str, Any],
    stages: Nodes,
    behind: Nodes = MappingProxyType({}),
    disc: tuple[float, float] | None = None,
) -> Network:
    """Scene, MTFs in turn, picture, and what makes pictures of it.

    `init` has the parameters of the sensor; `stages` are the MTFs between `init` and `back`,
    `behind` what takes the image from there; `disc` is the diameter (mm) and the wavelength (µm) of
    a clear aperture before all stages: of a pupil `pupil` the MTF `optics`.
    """
    nodes: dict[str, tuple[str, Mapping[str, Any]]] = {"scene": scene, "init": ("init_trans", init)}
    links = [(SCENE, "init.image"), ("init.phase", "back.phase")]
    if disc is not None:
        side_cm, wavelength = 0.2 * disc[0], disc[1]
        optics = {"cut_on_um": wavelength, "cut_off_um": wavelength}
        optics |= {"size_x_cm": side_cm, "size_y_cm": side_cm}
        nodes["pupil"] = ("exit_pupil", {"size_x": 512, "size_y": 512, "radius": 128.0})
        stages = {"optics": ("exit_pupil_mtf", optics), **stages}
        links += [("pupil.pupil", "optics.pupil"), ("init.phase", "optics.phase")]
    before = "init"
    for stage in stages:
        links += [("init.context", f"{stage}.context")]
        links += [(f"{before}.magnitude", f"{stage}.magnitude")]
        before = stage
    links.append((f"{before}.magnitude", "back.magnitude"))
    nodes |= {**stages, "back": ("back_transform", {}), **behind}
    for node in behind:
        links += [("back.image", f"{node}.image"), ("init.context", f"{node}.context")]
    return Network(
        nodes={name: Node(name, key, dict(params)) for name, (key, params) in nodes.items()},
        links=tuple(Link.between(*link) for link in links),
    )
