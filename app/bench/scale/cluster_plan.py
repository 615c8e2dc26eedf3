"""From rates that were measured on one machine to cores, hours and disk of a large plan."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

SAMPLE_BYTES = 4  # of an input or output, single precision
DISK_BYTES_PER_S = 1e9
_IN_MEMORY_AT_ONCE = 8  # pictures of a run


@dataclass(frozen=True)
class Rates:
    """What a sample takes.

    Parameters
    ----------
    core_ns : float
        Nanoseconds of one core.
    written_bytes : float
        Bytes written to disk.
    scratch_bytes : float
        Bytes that lie on disk at a time, inputs and outputs left out.
    """

    core_ns: float
    written_bytes: float
    scratch_bytes: float


@dataclass(frozen=True)
class Plan:
    """What a plan takes."""

    what: str
    cores: int
    core_hours: float
    hours: float
    limit: str
    disk_bytes: float
    memory_bytes: float

    def row(self) -> dict[str, Any]:
        """For a table."""
        return {
            "what": self.what,
            "cores": self.cores,
            "core_hours": self.core_hours,
            "hours": self.hours,
            "limit": self.limit,
            "disk_GB": self.disk_bytes / 1e9,
            "memory_GB": self.memory_bytes / 1e9,
        }


def scenes_plan(rates: Rates, *, scenes: int, side: int, cores: int) -> Plan:
    """Many scenes in memory, one on each core at a time; inputs and outputs on disk."""
    samples = scenes * side * side
    core_hours = samples * rates.core_ns / 3.6e12
    return Plan(
        what=f"{scenes:,} scenes of {side}²",
        cores=cores,
        core_hours=core_hours,
        hours=core_hours / cores,
        limit="computing",
        disk_bytes=2.0 * samples * SAMPLE_BYTES,
        memory_bytes=float(cores * side * side * SAMPLE_BYTES * _IN_MEMORY_AT_ONCE),
    )


def frame_plan(
    rates: Rates,
    *,
    side: int,
    cores: int,
    disk_bytes_per_s: float = DISK_BYTES_PER_S,
    memory_bytes: float = 2e9,
) -> Plan:
    """One frame in blocks on a machine: as long as its computing, or as its disk writes."""
    samples = side * side
    core_hours = samples * rates.core_ns / 3.6e12
    computing = core_hours / cores
    writing = samples * rates.written_bytes / disk_bytes_per_s / 3600.0
    return Plan(
        what=f"a frame of {side:,}²",
        cores=cores,
        core_hours=core_hours,
        hours=max(computing, writing),
        limit="computing" if computing >= writing else "the disk",
        disk_bytes=samples * (2.0 * SAMPLE_BYTES + rates.scratch_bytes),
        memory_bytes=memory_bytes,
    )
