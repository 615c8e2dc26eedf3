"""How time is measured: a subject and the bare Fourier round trip T0 in turn, median of ratios."""

import os
import platform
import statistics
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import scipy
import scipy.fft
from numpy.typing import NDArray

from app.run import terminal
from app.run.terminal import versions
from core.errors import UsageError
from core.machine import physical_bytes
from core.records import dataclass
from core.transfer.periodic import backend

Array = NDArray[Any]
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
        "versions": versions(),
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
