"""Options of a run."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from app.options.option_values import size_in_bytes
from app.run.saving import MOST_FRAMES
from core.errors import ParameterError
from core.evaluation.policy import Policy
from core.evaluation.region import Region

_REGION = "two slices for rows and columns, such as numpy.s_[100:164, :64]"


@dataclass(frozen=True)
class RunOptions:
    """Options of a run, as for `Chain.run`, and what decides where the chain may write.

    `file` is the network file, where the chain is in one; `given` are the nodes whose files were
    named in Python.
    """

    policy: Policy
    frames: int | None = None
    outputs: tuple[str, ...] | None = None
    region: tuple[slice, slice] | None = None
    memory: int | None = None
    scratch: Path = Path()
    file: Path | None = None
    given: frozenset[str] = frozenset()

    @classmethod
    def of(
        cls,
        policy: Policy,
        frames: int | None,
        outputs: Sequence[str] | None,
        region: tuple[slice, slice] | None,
        memory: int | str | None,
        scratch: str | PathLike[str] | None,
        **origin: Any,
    ) -> RunOptions:
        """The options, checked: raises `ParameterError` if one is not allowed."""
        if frames is not None and not (_is_whole(frames) and 1 <= frames <= MOST_FRAMES):
            raise ParameterError("frames", frames, f"a whole number from 1 to {MOST_FRAMES}")
        chosen = (outputs,) if isinstance(outputs, str) else outputs
        if region is not None and not (
            isinstance(region, tuple)
            and len(region) == 2
            and all(isinstance(part, slice) and part.step in (None, 1) for part in region)
        ):
            raise ParameterError("region", region, _REGION)
        ports = None if chosen is None else tuple(chosen)
        folder = current_folder() if scratch is None else Path(fspath(scratch))
        return cls(policy, frames, ports, region, _bytes(memory), folder, **origin)

    def region_of(self, shape: tuple[int, int]) -> Region | None:
        """The rows and columns to compute in a picture of that shape; None for all of it.

        Raises `ParameterError` if the region is empty.
        """
        if self.region is None:
            return None
        (top, bottom, _), (left, right, _) = (
            part.indices(length) for part, length in zip(self.region, shape, strict=True)
        )
        if bottom <= top or right <= left:
            allowed = f"{_REGION}, within the picture's {shape[0]} rows and {shape[1]} columns"
            raise ParameterError("region", self.region, allowed)
        return Region(top, left, bottom - top, right - left)


def current_folder() -> Path:
    """The current folder; its old path if it has been removed."""
    try:
        return Path.cwd()
    except FileNotFoundError:
        return Path(os.environ.get("PWD", "/"))


def whole_path(path: str | PathLike[str]) -> Path:
    """The absolute path of a file; links are not resolved."""
    return Path(os.path.normpath(current_folder() / fspath(path)))


def _bytes(memory: int | str | None) -> int | None:
    """Bytes from a number, or a text as ``run --memory`` takes it."""
    if isinstance(memory, str):
        return size_in_bytes("memory", memory)
    if memory is None or (_is_whole(memory) and memory >= 1000):
        return memory
    raise ParameterError(
        "memory", memory, 'a number of bytes, 1000 or more, or a string such as "2GB"'
    )


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)
