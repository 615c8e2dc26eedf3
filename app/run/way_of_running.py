"""Whether a run holds its pictures in memory or makes them in blocks, on disk: a choice by size."""

from __future__ import annotations

import contextlib
import shutil
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.run.evaluation import needed_later, read_by_evaluation
from core.chain.block_plan import LargestPicture, largest_picture, least_scratch, planned_blocks
from core.chain.engine import Engine, Plan
from core.chain.wires import Image, SpectrumWire, Transfer
from core.errors import DataError, FileError, UsageError
from core.evaluation.store import Store
from core.evaluation.work import BlockRun, Policy, Work
from core.machine import amount_text, usable_bytes
from core.scratch import ScratchDisk, is_for_disk
from nodes.files.common.file_format import ENVI_FRAMES, ZARR
from nodes.files.formats import NPY, TIFF

Array = NDArray[Any]
STREAMED = (NPY, TIFF, ENVI_FRAMES, ZARR)
"""Formats that are written row after row, or chunk after chunk."""
_PREVIEW_PX = 2048
_SHARE = 0.5  # of what the process may use
_SHARE_KEPT = 8  # of the budget, that values of a run in blocks may take


@dataclass(frozen=True)
class WayOfRunning:
    memory_bytes: int | None  # what pictures may take; None where no limit is known
    largest: LargestPicture | None  # the largest picture of the network
    # what they may take after all where a node cannot work in blocks: all memory there is, unless
    # an amount was given
    at_most_bytes: int = 0

    @property
    def in_blocks(self) -> bool:
        if self.memory_bytes is None or self.largest is None:
            return False
        return self.largest.memory_bytes > self.memory_bytes

    def on_disk(self, value: Any, policy: Policy) -> bool:
        if not self.in_blocks or self.memory_bytes is None or not isinstance(value, Image):
            return False
        return is_for_disk(value.shape, policy.dtype, self.memory_bytes)

    def store(self, otherwise: Store | None) -> Store | None:
        if not self.in_blocks or self.memory_bytes is None:
            return otherwise
        return Store(self.memory_bytes // _SHARE_KEPT)

    def facts(self, blocks: BlockRun | None) -> dict[str, Any]:
        facts: dict[str, Any] = {
            "way": "in memory" if blocks is None else "in blocks",
            "memory_bytes": self.memory_bytes,
        }
        if self.largest is not None:
            facts |= {
                "largest_rows": self.largest.rows,
                "largest_columns": self.largest.columns,
                "in_memory_bytes": self.largest.memory_bytes,
            }
        if blocks is not None:
            disk = blocks.disk
            facts |= {"scratch_bytes": disk.most_bytes, "scratch_arrays": disk.files}
        return facts


def way_of_running(plan: Plan, policy: Policy, memory_bytes: int | None) -> WayOfRunning:
    """The way for a network under a budget, by default half of what the process may use."""
    largest = largest_picture(plan, policy)
    if memory_bytes is not None:
        return WayOfRunning(memory_bytes, largest)
    usable = usable_bytes()
    if usable is None:
        return WayOfRunning(None, largest)
    return WayOfRunning(int(usable * _SHARE), largest, usable)


def way_in_words(facts: dict[str, Any]) -> str:
    largest = f"{facts['largest_rows']} × {facts['largest_columns']} samples"
    needed, allowed = amount_text(facts["in_memory_bytes"]), amount_text(facts["memory_bytes"])
    if facts["way"] == "in memory":
        return f"in memory: pictures of {largest} take up to {needed}; the limit is {allowed}"
    return (
        f"in blocks: pictures of {largest} would take up to {needed} in memory, but the limit is "
        f"{allowed}; up to {amount_text(facts['scratch_bytes'])} were on disk in "
        f"{facts['scratch_arrays']} arrays, transformed by rows and columns"
    )


@contextlib.contextmanager
def blocks_of(
    way: WayOfRunning,
    engine: Engine,
    plan: Plan,
    policy: Policy,
    *,
    ports: Sequence[str],
    report: bool,
    scratch: Path,
) -> Iterator[BlockRun | None]:
    """What a run in blocks keeps on disk, as long as it is open; None for a run in memory."""
    if not way.in_blocks or way.memory_bytes is None:
        yield None
        return
    with ScratchDisk(scratch, way.memory_bytes) as disk:
        _refuse_planes(plan, ports, disk, policy)
        later = needed_later(plan, ports, report=report, in_blocks=True)
        recipes = [*read_by_evaluation(engine, plan), *later]
        try:
            blocks = planned_blocks(plan, recipes, disk, policy)
        except DataError:
            if way.largest is None or way.largest.memory_bytes > way.at_most_bytes:
                raise
            yield None
            return
        _refuse_without_room(least_scratch(recipes, blocks, policy), scratch)
        yield blocks


def is_streamed(image: Image, path: Path, *, on_disk: bool) -> bool:
    if ENVI_FRAMES.matches(path):
        return image.bands is None
    return on_disk and TIFF.matches(path)


def reduced(samples: Array, work: Work) -> Array:
    """A picture as it is; one that is made in blocks as means of as many samples as shows it."""
    if work.blocks is None or not work.blocks.disk.wants(samples.shape, samples.dtype):
        return samples
    step = -(-max(samples.shape) // _PREVIEW_PX)
    rows, columns = (size // step for size in samples.shape)
    if not rows or not columns:
        return samples[::step, ::step]
    made = np.empty((rows, columns), samples.dtype)
    for row in range(rows):
        lines = samples[row * step : (row + 1) * step, : columns * step]
        made[row] = lines.reshape(step, columns, step).mean(axis=(0, 2), dtype=np.float64)
    return made


def check_streamed(port: str, image: Image, path: Path, frames: int | None) -> None:
    """Refuse a format in which a picture on disk cannot be written row after row, and frames."""
    if frames is not None and frames > 1:
        raise UsageError(
            f"{frames} frames: a picture of {image.rows} × {image.columns} samples is "
            "computed in blocks and can have only one frame: give 1, or run again with "
            "another seed"
        )
    if not any(kind.matches(path) for kind in STREAMED):
        words = " ".join(suffix for kind in STREAMED for suffix in kind.suffixes)
        raise UsageError(
            f"--save {port}={path}: a picture of {image.rows} × {image.columns} samples that is "
            f"computed in blocks must be written as {words}"
        )


def _refuse_planes(plan: Plan, ports: Iterable[str], disk: ScratchDisk, policy: Policy) -> None:
    for port in ports:
        value: Any = plan.output(port)
        plane = isinstance(value, SpectrumWire | Transfer)
        if plane and disk.wants(value.grid.shape, policy.dtype):
            raise UsageError(
                f"--save {port}: a {value.port_type} of {value.grid.rows} × {value.grid.columns} "
                "samples must be computed all at once but does not fit in --memory "
                f"{amount_text(disk.memory_bytes)}"
            )


def _refuse_without_room(needed: int, scratch: Path) -> None:
    try:
        free = shutil.disk_usage(scratch).free
    except OSError as error:
        reason = error.strerror or error
        raise FileError(f"cannot write to the scratch folder {scratch}: {reason}") from error
    if needed > free:
        raise FileError(
            f"the scratch folder {scratch} has {amount_text(free)} free, and a run in blocks "
            f"needs at least {amount_text(needed)}: choose another folder",
            hint="give it with --scratch",
        )
