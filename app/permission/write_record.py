"""What a network has written for this user, and where the user lets it write."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import stat
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from app.permission.state_folder import state_folder
from core.atomic import write_text
from core.errors import FileError
from core.file_lock import in_turn
from nodes.files.stores.store_folder import is_store

FORMAT, VERSION = "imagechain-writes", 1
_DAMAGED = (OSError, ValueError, TypeError, AttributeError, LookupError, RecursionError)
Print = tuple[int, str]
"""Size and SHA-256 of a file's content."""


@dataclass(frozen=True)
class WriteRecord:
    """The record of one network file, in a file of the user's state folder.

    It is there and not beside the network, because a network that came from elsewhere could
    bring a record of its own. One that is lost or damaged counts as empty.

    Parameters
    ----------
    network : Path
        The network's file, links resolved.
    written : mapping
        What it has written: contents by file.
    chosen : frozenset of Path
        Files that the user has chosen in a dialog to be written.
    """

    network: Path
    written: Mapping[Path, tuple[Print, ...]] = field(default_factory=dict)
    chosen: frozenset[Path] = frozenset()

    def holds(self, file: Path) -> bool:
        """Whether a file is still as this network has written it."""
        known = self.written.get(file, ())
        with contextlib.suppress(OSError):
            status = file.lstat()
            if is_store(file):
                return not file.is_symlink() and fingerprint(file) in known
            alike = any(entry[0] == status.st_size for entry in known)
            return alike and stat.S_ISREG(status.st_mode) and fingerprint(file) in known
        return False


def read_record(network: Path) -> WriteRecord:
    """The record of a network's file; empty where there is none."""
    real = Path(os.path.realpath(network))
    path = _place(real)
    with contextlib.suppress(*_DAMAGED):
        content = json.loads(path.read_bytes()) if path is not None else None
        if isinstance(content, dict) and content.get("network") == str(real):
            return _read(real, content)
    return WriteRecord(real)


def write_record(record: WriteRecord) -> None:
    """Keep a record.

    Raises
    ------
    FileError
        If it cannot be written.
    """
    path = _place(record.network)
    if path is None:
        raise FileError("there is no folder of the user's to keep it in")
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot write {path}: {error.strerror or error}") from error
    content = {
        "format": FORMAT,
        "version": VERSION,
        "network": str(record.network),
        "written": {str(file): prints for file, prints in record.written.items()},
        "chosen": sorted(map(str, record.chosen)),
    }
    # As ASCII: a path that is no valid Unicode can be written and comes back as it was.
    write_text(path, json.dumps(content, indent=1) + "\n")


def remember_chosen(network: Path, files: Iterable[Path]) -> None:
    """Add files that the user has chosen to a network's record.

    Raises
    ------
    FileError
        If it cannot be written.
    """
    with changing(network):
        known = read_record(network)
        chosen = known.chosen | frozenset(Path(os.path.realpath(file)) for file in files)
        if chosen != known.chosen:
            write_record(WriteRecord(known.network, known.written, chosen))


@contextlib.contextmanager
def changing(network: Path) -> Iterator[None]:
    """Hold off other processes that read and write a network's record."""
    path = _place(Path(os.path.realpath(network)))
    if path is None:
        yield
        return
    with contextlib.suppress(OSError):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with in_turn(path.with_suffix(".lock")):
        yield


def fingerprint(file: Path) -> Print:
    """Size and hash of what a file holds, or a store of files with their names."""
    if is_store(file):
        parts = sorted(part for part in file.rglob("*") if not part.is_dir())
        prints = [(part.relative_to(file).as_posix(), fingerprint(part)) for part in parts]
        whole = json.dumps(prints).encode()
        return sum(size for _, (size, _) in prints), hashlib.sha256(whole).hexdigest()
    with file.open("rb") as opened:
        digest = hashlib.file_digest(opened, "sha256").hexdigest()
        return opened.tell(), digest


def _place(network: Path) -> Path | None:
    folder = state_folder()
    if folder is None:
        return None
    name = hashlib.sha256(os.fsencode(network)).hexdigest()[:32]
    return folder / "writes" / f"{name}.json"


def _read(network: Path, content: dict[str, Any]) -> WriteRecord:
    if content["format"] != FORMAT or content["version"] != VERSION:
        raise ValueError("it is of another kind")
    written = {
        Path(file): tuple((int(size), str(digest)) for size, digest in prints)
        for file, prints in content["written"].items()
    }
    return WriteRecord(network, written, frozenset(Path(file) for file in content["chosen"]))
