"""A lens' file that a network names: found, described and read in the state it was planned with."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from core.modules.declaration import NodeContext
from nodes.files.common.paths import readable_file
from nodes.files.headers.envi_header import header_beside
from nodes.files.lens.lens_samples import LensSamples, describe_lens_samples, read_lens_samples
from nodes.input_output.source_file import Stamp, check_unchanged, stamps_of


@dataclass(frozen=True)
class LensSource:
    """A file with what is known of it; `reading` goes into a step's parameters."""

    file: Path
    stamps: tuple[Stamp, ...]
    band: int
    samples: LensSamples

    @property
    def reading(self) -> dict[str, Any]:
        """Arguments of `stored_samples`, by which the file's state enters a step's key."""
        return {"file": self.file, "stamps": self.stamps, "band": self.band}


def lens_source(path: Path, here: NodeContext, *, band: int = 0) -> LensSource:
    """Find and describe a file, relative to the network's folder.

    Raises
    ------
    FileError
        The file is missing, damaged or of an unknown format.
    """
    file = readable_file((here.folder / path).absolute())
    stamps = stamps_of(file, header_beside(file))
    return LensSource(file, stamps, band, _described(file, stamps, band))


def stored_samples(*, file: Path, stamps: tuple[Stamp, ...], band: int) -> NDArray[Any]:
    """The samples, of the file as it was described.

    Raises
    ------
    FileError
        The file cannot be read, or is another one than was planned with.
    """
    check_unchanged(file, stamps)
    return read_lens_samples(file, band)


@lru_cache(maxsize=64)
def _described(file: Path, stamps: tuple[Stamp, ...], band: int) -> LensSamples:
    return describe_lens_samples(file, band)
