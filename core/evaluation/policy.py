"""How accurately and with how many threads to compute: one immutable value, passed along."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Literal

import numpy as np

from core.errors import ParameterError

Precision = Literal["single", "double"]


@dataclass(frozen=True)
class Policy:
    """Numerical policy of one evaluation.

    `precision` is that of pictures and spectra; vectors and sums are always double. `tolerance` is
    the error budget: stages whose effect, as a fraction of the picture's range, stays below it are
    left out. 0 leaves out exact identities only; None is an eighth of the samples' rounding. 0
    `threads` are as many as the process may use; results do not depend on them.
    """

    precision: Precision = "single"
    tolerance: float | None = None
    threads: int = 0

    def __post_init__(self) -> None:
        if self.precision not in ("single", "double"):
            raise ParameterError("precision", self.precision, "single or double")
        if self.tolerance is not None and not 0 <= self.tolerance < 1:
            raise ParameterError("tolerance", self.tolerance, "0 ≤ tolerance < 1")
        if not 0 <= self.threads <= 1024:
            raise ParameterError("threads", self.threads, "0 (all) to 1024")

    @property
    def dtype(self) -> np.dtype[np.floating]:
        return np.dtype(np.float32 if self.precision == "single" else np.float64)

    @property
    def budget(self) -> float:
        if self.tolerance is None:
            return float(np.finfo(self.dtype).eps) / 8
        return self.tolerance

    @property
    def workers(self) -> int:
        if self.threads:
            return self.threads
        allowed = getattr(os, "sched_getaffinity", None)  # not on every system
        return len(allowed(0)) if allowed is not None else os.cpu_count() or 1

    @property
    def key(self) -> str:
        """What of the policy a result depends on."""
        return f"{self.precision}/{self.budget!r}"
