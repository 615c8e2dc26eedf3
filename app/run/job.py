"""A run that goes on in a process of its own: a network as it was, and what to make of it."""

from __future__ import annotations

import json
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Any, Literal, get_args

from app.run.readout_tables import number_text
from core.errors import UsageError

Kind = Literal["report", "run", "frames", "sweep", "files"]
REPORT = "report.html"
FRAMES = "frames.npy"
_BARRED = re.compile(r'[<>:"/\\|?*\x00-\x1f]')  # in names of files, on one system or another
_LONGEST = 80


@dataclass(frozen=True)
class Job:
    """What one background run does.

    Parameters
    ----------
    kind : str
        ``report``: only the report of the network; ``run``: all that ``imagechain run`` writes;
        ``frames``: that, and frames of the delivered picture; ``sweep``: figures, and perhaps
        pictures, at each value of a parameter; ``files``: a run for each of several files.
    network : str
        The text of the network file.
    folder : Path
        What file names in the network are relative to.
    path : Path or None
        The network's file; None where it was never saved.
    output : Path
        The folder to write in; the file of a ``report``.
    chosen : tuple of Path
        Files that the person has chosen to be written.
    target : str
        ``NODE.PARAM`` that takes the values.
    values : tuple
        Its values, as a network file has them.
    log : bool
        Whether these are equal factors apart.
    pictures : bool
        Whether a sweep makes a run, with its picture, at each value.
    report : bool
        Whether each run writes a report.
    frames : int
        How many frames.
    """

    kind: Kind
    network: str
    folder: Path
    path: Path | None
    output: Path
    chosen: tuple[Path, ...] = ()
    target: str = ""
    values: tuple[Any, ...] = ()
    log: bool = False
    pictures: bool = True
    report: bool = False
    frames: int = 0

    @property
    def variants(self) -> tuple[Variant, ...]:
        """The runs it consists of; a single one has no name."""
        if self.kind not in ("sweep", "files"):
            return (Variant("", ()),)
        if self.kind == "sweep" and not self.pictures:
            return ()
        node, _, name = self.target.rpartition(".")
        texts = [self._name(value) for value in self.values]
        return tuple(
            Variant(folder, ((node, name, value),))
            for folder, value in zip(_apart(texts), self.values, strict=True)
        )

    def _name(self, value: Any) -> str:
        if self.kind == "files":
            return PurePath(value).stem
        return f"{self.target}={value if isinstance(value, str) else number_text(value)}"


@dataclass(frozen=True)
class Variant:
    """One of several runs: the name of its folder; node, parameter and value of what differs."""

    name: str
    settings: tuple[tuple[str, str, Any], ...]


def job_text(job: Job) -> str:
    """One line of text from which `read_job` makes the job again."""
    content: dict[str, Any] = {
        **vars(job),
        "folder": str(job.folder),
        "path": None if job.path is None else str(job.path),
        "output": str(job.output),
        "chosen": list(map(str, job.chosen)),
        "values": list(job.values),
    }
    # As ASCII: a path that is no valid Unicode comes back as it was.
    return json.dumps(content)


def read_job(text: str) -> Job:
    """The job of a line of text.

    Raises
    ------
    UsageError
        If it is none.
    """
    try:
        content = json.loads(text)
        return _job(content)
    except (ValueError, TypeError, LookupError, AttributeError) as error:
        raise UsageError(f"no job is written there: {error}") from None


def _job(content: Mapping[str, Any]) -> Job:
    if content["kind"] not in get_args(Kind):
        raise ValueError(f"kind = {content['kind']!r:.80}")
    path = content["path"]
    return Job(
        **{
            **content,
            "folder": Path(content["folder"]),
            "path": None if path is None else Path(path),
            "output": Path(content["output"]),
            "chosen": tuple(map(Path, content["chosen"])),
            "values": tuple(content["values"]),
        }
    )


def _apart(names: list[str]) -> list[str]:
    """Names that a folder can have, each one once: the same one again gets a number."""
    fit = [_BARRED.sub("_", name)[:_LONGEST].strip(" .") or "_" for name in names]
    known = Counter(name.casefold() for name in fit)  # some systems take A for a
    taken = {name for name, number in known.items() if number == 1}
    apart = []
    for name in fit:
        free, number = name, 1
        while known[name.casefold()] > 1 and (number == 1 or free.casefold() in taken):
            free, number = f"{name}-{number}", number + 1
        taken.add(free.casefold())
        apart.append(free)
    return apart
