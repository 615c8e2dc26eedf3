"""What the figures of a benchmark depend on."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from app.options.command_options import version
from core.filtering.fft_backend import backend
from core.memory import physical_bytes


def machine_facts() -> dict[str, Any]:
    """Processor, cores, memory, load, transforms and versions."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "usable_cores": len(os.sched_getaffinity(0)),
        "memory_bytes": physical_bytes() or 0,
        "load": os.getloadavg()[0],
        "system": platform.platform(),
        "fft": fft_backend(),
        "versions": {
            "imagechain": version(),
            "python": platform.python_version(),
            "numpy": np.__version__,
            "scipy": scipy.__version__,
        },
    }


def fft_backend() -> str:
    """What computes the Fourier transforms of periodic frames; all others, and T0, are scipy's."""
    return backend()


def machine_words(facts: Mapping[str, Any]) -> list[str]:
    """The facts as people read them."""
    return [
        facts["processor"],
        f"{facts['usable_cores']} of {facts['cores']} cores",
        f"{facts['memory_bytes'] / 2**30:.0f} GiB",
        f"load {facts['load']:.1f} at the start",
        *(f"{name} {release}" for name, release in facts["versions"].items()),
        f"periodic frames by {facts['fft']}",
    ]


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
