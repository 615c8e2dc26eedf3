"""What the last bits of a result depend on: libraries, processor, and what is set for them."""

import os
import platform
from pathlib import Path
from typing import Any

import numpy as np
import scipy
from numpy._core import _multiarray_umath

from core.evaluation.work import Policy
from core.transfer.periodic import backend

# Each makes a library take other code than the processor would.
SETTINGS = (
    "GLIBC_TUNABLES",
    "MKL_CBWR",
    "MKL_NUM_THREADS",
    "NPY_DISABLE_CPU_FEATURES",
    "OMP_NUM_THREADS",
    "OPENBLAS_CORETYPE",
    "OPENBLAS_NUM_THREADS",
)


def machine_tag() -> dict[str, Any]:
    """Where two of these are equal, so must be the bits."""
    return {
        "python": ".".join(platform.python_version_tuple()[:2]),  # 3.12 sums floats otherwise
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "transforms": backend(),
        "system": f"{platform.system()} {platform.machine()}",
        "libc": " ".join(platform.libc_ver()),
        "blas": np.show_config(mode="dicts")["Build Dependencies"]["blas"].get("version", ""),
        "processor": _processor(),
        "cores": Policy().workers,  # BLAS sums in as many parts, whatever --threads says
        "features": [name for name, has in _multiarray_umath.__cpu_features__.items() if has],
        "settings": {name: os.environ[name] for name in SETTINGS if name in os.environ},
    }


def _processor() -> dict[str, str]:
    """Vendor, family and model, by which BLAS picks its kernels; empty where none says."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
    except OSError:
        return {}
    first = text.partition("\n\n")[0]
    lines = (line.partition(":") for line in first.splitlines())
    cells = {name.strip(): value.strip() for name, _, value in lines}
    return {name: cells[name] for name in ("vendor_id", "cpu family", "model") if name in cells}
