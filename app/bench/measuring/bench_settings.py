"""How much a benchmark measures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from app.options.command_options import Options
from core.errors import UsageError
from core.evaluation.policy import Policy

PARTS = {
    "speed": "Speed",
    "precision": "Time against error",
    "peers": "Beside other programs",
    "editor": "The window",
    "scale": "How far it goes",
    "measure": "Measuring pictures, and fitting to them",
}
TABLES = {
    "speed": ("networks", "one_thread", "cameras", "frames", "growth", "fresh_process"),
    "precision": (
        "precision",
        "edges",
        "pupil_sampling",
        "interpolation",
        "low_rank",
        "wavelengths",
        "bands",
        "charge_transfer",
        "poisson",
        "poisson_quantile",
        "skipping",
        "scanning",
        "spatial",
    ),
    "peers": ("peers", "peer_cameras"),
    "editor": ("editor",),
    "scale": ("study_points", "study_scenes", "scale_blocks", "scale_plan"),
    "measure": ("measure", "fit"),
}
SIZE = 1024
LARGEST = 8192


@dataclass(frozen=True)
class Settings:
    """Parts, sizes and repetitions.

    Parameters
    ----------
    parts : tuple of str
        Names out of `PARTS`.
    size : int
        Samples along each side of the picture.
    quick : bool
        Fewer repetitions and sizes.
    """

    parts: tuple[str, ...]
    size: int = SIZE
    quick: bool = False

    @classmethod
    def of(cls, options: Options) -> Settings:
        """The settings of the command line.

        Raises
        ------
        UsageError
            For a size that the networks cannot take.
        """
        size = SIZE if options.size is None else options.size
        if not 32 <= size <= LARGEST or size % 4:
            raise UsageError(f"--size {size}: give a multiple of 4 from 32 to {LARGEST}")
        return cls(tuple(name for name in PARTS if name in options.parts or not options.parts),
                   size, options.quick)  # fmt: skip

    @property
    def pairs(self) -> int:
        """Repetitions of a subject, each beside a T0 of its own."""
        return 5 if self.quick else 15

    @property
    def slow_pairs(self) -> int:
        """Repetitions of what takes many T0."""
        return 2 if self.quick else 5

    @property
    def starts(self) -> int:
        """Processes of which each takes the time of a start."""
        return 1 if self.quick else 5

    @property
    def threads(self) -> int:
        """Threads of a round trip, as many as the engine takes."""
        return Policy().workers

    @property
    def small(self) -> int:
        """Size of a picture for comparisons with direct sums, which take size³ steps."""
        return min(self.size, 256) if self.quick else self.size

    @property
    def growing(self) -> tuple[int, ...]:
        """Sizes of the growing picture."""
        first = min(256, self.size // 2)
        last = self.size if self.quick or self.size != SIZE else LARGEST
        sizes = [first]
        while 2 * sizes[-1] <= last:
            sizes.append(2 * sizes[-1])
        return tuple(sizes)

    def words(self) -> list[str]:
        """Options of the command line that give these settings."""
        words = ["--quick"] if self.quick else []
        if self.parts != tuple(PARTS):
            words += [f"--only {part}" for part in self.parts]
        return [*words, f"--size {self.size}"] if self.size != SIZE else words

    def facts(self) -> dict[str, Any]:
        """For the JSON file."""
        return {
            "parts": list(self.parts),
            "size": self.size,
            "quick": self.quick,
            "pairs": self.pairs,
            "threads": self.threads,
        }
