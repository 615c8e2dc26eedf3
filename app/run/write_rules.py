"""Where a network may write: its origin is unknown, and it names its files itself."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shlex
import stat
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from app.run.shipped import Place
from app.run.staging import Guard, Staging, real_target
from app.user_folders import state_folder
from core.atomic import in_turn, write_text
from core.errors import FileError, ImagechainError, UsageError, shown
from nodes.files.store_folder import is_store

OPTION = "--allow-writes-to"
FORMAT, VERSION = "imagechain-writes", 1
_DAMAGED = (OSError, ValueError, TypeError, AttributeError, LookupError, RecursionError)
Print = tuple[int, str]
"""Size and SHA-256 of a file's content."""


@dataclass(frozen=True)
class WriteRecord:
    """What one network file has written, in a file of the user's state folder.

    There, because a network could bring a record of its own; one that is damaged counts as empty.
    """

    network: Path  # the network's file, links resolved
    # what it has written: contents by file
    written: Mapping[Path, tuple[Print, ...]] = field(default_factory=dict)
    # files that the user has chosen in a dialog to be written
    chosen: frozenset[Path] = frozenset()

    def holds(self, file: Path) -> bool:
        known = self.written.get(file, ())
        with contextlib.suppress(OSError):
            status = file.lstat()
            if is_store(file):
                return not file.is_symlink() and fingerprint(file) in known
            alike = any(entry[0] == status.st_size for entry in known)
            return alike and stat.S_ISREG(status.st_mode) and fingerprint(file) in known
        return False


def read_record(network: Path) -> WriteRecord:
    real = Path(os.path.realpath(network))
    with contextlib.suppress(*_DAMAGED):
        content = json.loads(_place(real).read_bytes())
        kind = content["format"], content["version"], content["network"]
        if kind == (FORMAT, VERSION, str(real)):
            written = {
                Path(file): tuple((int(size), str(digest)) for size, digest in prints)
                for file, prints in content["written"].items()
            }
            return WriteRecord(real, written, frozenset(map(Path, content["chosen"])))
    return WriteRecord(real)


def _add(network: Path, written: Mapping[Path, tuple[Print, ...]], chosen: Iterable[Path]) -> None:
    """Add to the record as it is now: another run, or the editor, may have changed it."""
    known = read_record(network)
    there = {file: prints for file, prints in known.written.items() if os.path.lexists(file)}
    path = _place(known.network)
    try:
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot write {path}: {error.strerror or error}") from error
    content = {
        "format": FORMAT,
        "version": VERSION,
        "network": str(known.network),
        "written": {str(file): prints for file, prints in {**there, **written}.items()},
        "chosen": sorted(map(str, known.chosen.union(chosen))),
    }
    # As ASCII: a path that is no valid Unicode can be written and comes back as it was.
    write_text(path, json.dumps(content, indent=1) + "\n")


def remember_chosen(network: Path, files: Iterable[Path]) -> None:
    with changing(network):
        _add(network, {}, (Path(os.path.realpath(file)) for file in files))


@contextlib.contextmanager
def changing(network: Path) -> Iterator[None]:
    """Hold off other processes that read and write a network's record."""
    path = _place(Path(os.path.realpath(network)))
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


@dataclass(frozen=True)
class WriteRules:
    """What the nodes of one network may write.

    Files in its folder or the output folder, unless one is there that it has not written; and in
    any case what is `allowed`, `given`, or chosen in a dialog of the editor.
    """

    # where it may make files, and where it may replace any; links resolved
    folders: tuple[Path, ...]
    allowed: tuple[Path, ...]
    given: frozenset[str]  # nodes whose file the user has named on the command line
    record: WriteRecord  # what it has written before
    how_to_allow: str = ""  # what lifts the rule where there is no command line

    def check(self, node: str, target: Path) -> None:
        try:
            self._check(node, target)
        except OSError as error:
            reason = error.strerror or error
            raise FileError(f"cannot write {target}: {reason}", node=node or None) from error

    def _check(self, node: str, target: Path) -> None:
        real = Path(os.path.realpath(target))
        # A node may add the suffix of its format to the name that was chosen.
        chosen = {real, real.parent / real.stem} & self.record.chosen
        if node in self.given or chosen:
            return
        if any(real.is_relative_to(folder) for folder in self.allowed):
            return
        lift = self.how_to_allow or f"{OPTION} {shlex.quote(str(real.parent))} allows it"
        leads = f" (a link to {real})" if target.is_symlink() else ""
        if not any(real.is_relative_to(folder) for folder in self.folders):
            why = "it lies outside the network's folder and the output folder"
        elif (real.is_file() or is_store(real)) and not (
            self.record.holds(real) or read_record(self.record.network).holds(real)
        ):
            why = "the existing file was not written by this network, or has changed since"
        else:
            return
        raise FileError(f"cannot write {target}{leads}: {why}; {lift}", node=node or None)

    def _check_own(self, target: Path) -> None:
        """Refuse one of the run's own files where it is a link to what a node may not write."""
        if os.path.islink(target):  # noqa: PTH114, as Path's raises for a name that is too long
            self.check("", target)

    def claim(
        self, sinks: Mapping[str, Path], own: Iterable[Path], staging: Staging
    ) -> tuple[ImagechainError, ...]:
        """Reserve what a run writes; gives why some of it cannot or may not be written."""
        wanted: list[tuple[str, Path, Guard | None]] = [
            # Only a link may lead to what is not the run's own.
            ("", target, self._check_own if os.path.islink(target) else None)  # noqa: PTH114
            for target in own
        ]
        wanted += [(node, target, partial(self.check, node)) for node, target in sinks.items()]
        errors: list[ImagechainError] = []
        for node, target, guard in wanted:
            try:
                staging.claim(target, guard)
            except ImagechainError as error:
                errors.append(error.at(node) if node else error)
        return tuple(errors)

    def commit(self, staging: Staging) -> str:
        """Put the files in place, and record what nodes have written; gives why that failed, or "".

        Before, too: whatever a process leaves that is killed meanwhile is known.
        """
        try:
            new = {target: fingerprint(file) for target, file in staging.guarded()}
        except OSError as error:
            raise FileError(f"cannot read {error.filename}: {error.strerror or error}") from error
        with changing(self.record.network):
            before = read_record(self.record.network).written
            both = {target: (*before.get(target, ()), entry) for target, entry in new.items()}
            problem = self._remember(both)
            staging.commit()
            return problem or self._remember({target: (entry,) for target, entry in new.items()})

    def _remember(self, new: Mapping[Path, tuple[Print, ...]]) -> str:
        try:
            if new:
                _add(self.record.network, new, ())
        except FileError as error:
            return error.message
        return ""


def write_rules(
    place: Place,
    output: Path,
    *,
    named: bool = False,
    allowed: Sequence[Path] = (),
    given: Iterable[str] = (),
) -> WriteRules:
    """The rules of a run; `given` are nodes whose file the user has named."""
    for folder in allowed:
        if not os.path.isdir(folder):  # noqa: PTH112, as Path's raises for a long name
            raise UsageError(f"{OPTION} {shown(str(folder))}: there is no such folder")
    real = real_target(output)
    if not named and output.is_symlink():
        hint = f"--output-dir {shlex.quote(str(output))} allows it"
        raise FileError(f"cannot write to {output}: it is a link to {real}; {hint}")
    return WriteRules(
        folders=(*_own_folder(place), real),
        allowed=tuple(Path(os.path.realpath(folder)) for folder in allowed),
        given=frozenset(given),
        record=read_record(place.path),
    )


def _own_folder(place: Place) -> tuple[Path, ...]:
    """The network's folder; none where the network came on standard input."""
    folder = Path(os.path.realpath(place.folder))
    given = folder == Path("/dev") or folder.is_relative_to("/proc")
    return () if given else (folder,)


def _place(network: Path) -> Path:
    name = hashlib.sha256(os.fsencode(network)).hexdigest()[:32]
    return state_folder() / "writes" / f"{name}.json"
