"""Output files that appear together at the end, or not at all; and where these may be."""

import contextlib
import hashlib
import json
import os
import shlex
import shutil
import stat
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Self

from app.run.option_values import Assignment
from app.run.shipped import Place
from app.user_folders import FOLDERS
from core import atomic
from core.errors import FileError, ImagechainError, UsageError, placed, shown, writing
from core.modules.declaration import Declaration
from core.network.network import Node
from core.records import dataclass, field
from nodes.files.file_format import ZARR
from nodes.files.zarr_array import is_store

Writer = Callable[[Path], None]
Guard = Callable[[Path], None]


class Staging:
    """Collects files in hidden folders beside their targets; `commit` puts them in place.

    Whatever was not committed is gone at its end as a context manager. `folder` alone may be
    missing still; no output may replace one of the `inputs`.
    """

    def __init__(self, folder: Path | None, inputs: Iterable[Path] = ()) -> None:
        self._folder = None if folder is None else real_target(folder)
        self._inputs = {real_target(path) for path in inputs}
        self._claimed: dict[Path, Path] = {}  # by name, where links lead to
        self._staged: list[tuple[Path, Path, Path]] = []  # file, target, and how it was given
        self._guards: dict[Path, Guard] = {}
        self._places: dict[Path, Path] = {}
        self._open = contextlib.ExitStack()
        self._swept: set[Path] = set()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._open.close()

    def claim(self, target: Path, guard: Guard | None = None) -> None:
        """Reserve `target` for writing, so that a bad one is refused before any work.

        A `guard` raises if it may not be written: now, and before any file is put in place.
        """
        real = real_target(target)
        if real in self._claimed.values():
            raise FileError(f"cannot write: two outputs would be written to {target}")
        if guard is not None:
            guard(target)
            self._guards[real] = guard
        self.check(target)
        folder = _existing(real.parent)
        if folder not in self._swept:  # of what killed runs have left there
            self._swept.add(folder)
            atomic.sweep(folder)
        self._claimed[target] = real

    def check(self, target: Path) -> None:
        real = real_target(target)
        parent = real.parent
        # A store and what lies in it count as one.
        others = [path for path in self._inputs if ZARR.matches(real) and real in path.parents]
        if others or not self._inputs.isdisjoint((real, *real.parents)):
            raise FileError(f"cannot write {target}: the file is an input of this run")
        with writing(f"to {target}"):
            _check_existing(real, target)
            made = self._folder is not None and parent.is_relative_to(self._folder)
            if not parent.is_dir() and not made:
                raise FileError(f"cannot write {target}: there is no folder {target.parent}")
            folder = _existing(parent)
            if not folder.is_dir():
                raise FileError(f"cannot write {target}: {folder} is not a folder")
        if not os.access(folder, os.W_OK | os.X_OK):
            raise FileError(f"cannot write {target}: no permission to write in {folder}")

    def write(self, target: Path, writer: Writer, guard: Guard | None = None) -> None:
        """Have `writer` make the file under a temporary name of the same suffix."""
        self._check_way(target)
        real = real_target(target)
        if real not in self._claimed.values():
            self.claim(target, guard)
        if any(there == real for _, there, _ in self._staged):
            raise FileError(f"cannot write: two outputs would be written to {target}")
        file = self._place(real, target) / f"{len(self._staged)}{real.suffix}"
        try:
            with writing(target):
                writer(file)
        except ImagechainError as error:
            error.message = error.message.replace(str(file), str(target))
            raise
        self._staged.append((file, real, target))

    def protect(self, path: Path) -> None:
        self._inputs.add(real_target(path))

    def drop(self, folder: Path) -> None:
        real = real_target(folder)
        self._staged = [one for one in self._staged if not one[1].is_relative_to(real)]
        for target, file in list(self._claimed.items()):
            if file.is_relative_to(real):
                del self._claimed[target]
                self._guards.pop(file, None)

    def guarded(self) -> list[tuple[Path, Path]]:
        """Targets that have a guard, links resolved, each with the file prepared for it."""
        return [(target, file) for file, target, _ in self._staged if target in self._guards]

    def commit(self) -> None:
        """Put every file in its place; if one fails, the others are as before."""
        for _, target, given in self._staged:
            self._check_way(given)
            self.check(given)
            if (guard := self._guards.get(target)) is not None:
                guard(given)
        undo: list[Callable[[], object]] = []
        try:
            for file, target, given in self._staged:
                with writing(given):
                    _make_folders(target.parent, undo)
                    _put(file, target, undo)
        except BaseException:
            for step in reversed(undo):
                # One that cannot be undone must not keep the rest from it.
                with contextlib.suppress(OSError):
                    step()
            raise

    def _check_way(self, target: Path) -> None:
        now = real_target(target)
        if self._claimed.get(target, now) != now:
            raise FileError(
                f"cannot write {target}: since the run began, the file or a folder in its path "
                f"has become a link to {now}"
            )

    def _place(self, real: Path, target: Path) -> Path:
        # Beside the target, so that the final rename stays within one file system.
        folder = _existing(real.parent)
        if folder not in self._places:
            with writing(target):
                self._places[folder] = self._open.enter_context(atomic.temporary_folder(folder))
        return self._places[folder]


def input_paths(node: Node, declared: Declaration, folder: Path) -> list[Path]:
    """Files that a node reads: no output may take their place."""
    values = [] if declared.sink else [node.params.get(name) for name in declared.path_names]
    return [folder / value for value in values if isinstance(value, str) and value]


def existing_folder(folder: Path) -> Path:
    """A folder, or the nearest one above it that exists; links followed."""
    return _existing(real_target(folder))


def check_folder(folder: Path) -> None:
    above = folder
    with writing(f"to {folder}"):
        try:
            status = folder.stat()
        except FileNotFoundError:  # it will be made
            above = _existing(real_target(folder))
            status = above.stat()
        except NotADirectoryError as error:
            reason = "part of the path is not a folder"
            raise FileError(f"cannot write to {folder}: {reason}") from error
    if not stat.S_ISDIR(status.st_mode):
        raise FileError(f"cannot write to {folder}: it is not a folder")
    if not os.access(above, os.W_OK | os.X_OK):
        where = "" if above is folder else f" in {above}"
        raise FileError(f"cannot write to {folder}: no permission to write{where}")


def real_target(target: Path) -> Path:
    with writing(f"to {target}"):
        return Path(os.path.realpath(target))


def _check_existing(real: Path, target: Path) -> None:
    with writing(target):
        try:
            status = real.stat()
        except (FileNotFoundError, NotADirectoryError):
            return
    unfit = atomic.no_regular_file(status.st_mode)
    if ZARR.matches(real):
        other = "a file that is not a Zarr store already has this name; choose another name"
        unfit = "" if is_store(real) else other
    if unfit:
        raise FileError(f"cannot write {target}: {unfit}")
    if not os.access(real, os.W_OK):
        raise FileError(f"cannot write {target}: the file is read-only")


def _existing(folder: Path) -> Path:
    return next(above for above in (folder, *folder.parents) if above.exists())


def _make_folders(folder: Path, undo: list[Callable[[], object]]) -> None:
    missing = []  # no recursion: a path may have two thousand of them
    while not folder.exists():
        missing.append(folder)
        folder = folder.parent
    for each in reversed(missing):
        each.mkdir()
        undo.append(each.rmdir)


def _put(file: Path, target: Path, undo: list[Callable[[], object]]) -> None:
    backup = file.with_name(file.name + ".old")
    if file.is_dir():  # a store: one that is there makes room, and is gone with the stage
        if target.exists():
            target.replace(backup)
            undo.append(lambda: backup.replace(target))
        undo.append(lambda: target.replace(file))
    elif target.exists():
        shutil.copy2(target, backup)
        file.chmod(stat.S_IMODE(target.stat().st_mode))
        undo.append(lambda: backup.replace(target))
    else:
        undo.append(lambda: target.unlink(missing_ok=True))
    file.replace(target)


# Where a network may write: its origin is unknown, and it names its files itself.

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
    chosen: frozenset[Path] = frozenset()  # by the user in a dialog

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
    with writing(path):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    content = {
        "format": FORMAT,
        "version": VERSION,
        "network": str(known.network),
        "written": {str(file): prints for file, prints in {**there, **written}.items()},
        "chosen": sorted(map(str, known.chosen.union(chosen))),
    }
    # As ASCII: a path that is no valid Unicode can be written and comes back as it was.
    atomic.write_text(path, json.dumps(content, indent=1) + "\n")


def remember_chosen(network: Path, files: Iterable[Path]) -> None:
    with changing(network):
        _add(network, {}, (Path(os.path.realpath(file)) for file in files))


@contextlib.contextmanager
def changing(network: Path) -> Iterator[None]:
    """Hold off other processes that read and write a network's record."""
    path = _place(Path(os.path.realpath(network)))
    with contextlib.suppress(OSError):
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    with atomic.in_turn(path.with_suffix(".lock")):
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

    folders: tuple[Path, ...]  # where it may make files; links resolved
    allowed: tuple[Path, ...]
    given: frozenset[str]  # nodes whose file the user has named on the command line
    record: WriteRecord  # what it has written before
    how_to_allow: str = f"{OPTION} {{folder}} allows writing there"  # what lifts the rule

    def check(self, node: str, target: Path) -> None:
        with placed(node or None), writing(target):
            self._check(node, target)

    def _check(self, node: str, target: Path) -> None:
        real = Path(os.path.realpath(target))
        # A node may add the suffix of its format to the name that was chosen.
        chosen = {real, real.parent / real.stem} & self.record.chosen
        if node in self.given or chosen:
            return
        if any(real.is_relative_to(folder) for folder in self.allowed):
            return
        lift = self.how_to_allow.format(folder=shlex.quote(str(real.parent)))
        leads = f" (a link to {real})" if target.is_symlink() else ""
        if not any(real.is_relative_to(folder) for folder in self.folders):
            why = "the file lies outside the network's folder and the output folder"
        elif (real.is_file() or is_store(real)) and not (
            self.record.holds(real) or read_record(self.record.network).holds(real)
        ):
            why = "the existing file was not written by this network, or has changed since"
        else:
            return
        raise FileError(f"cannot write {target}{leads}: {why}; {lift}")

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
    place: Place, output: Path | None, allowed: Sequence[Path], settings: Iterable[Assignment]
) -> tuple[Path, WriteRules]:
    """The folder of a command's run, and its rules; `settings` may name files of nodes."""
    output_dir = output or Path(f"{place.name}-output")
    check_folder(output_dir)
    for folder in allowed:
        if not os.path.isdir(folder):  # noqa: PTH112, as Path's raises for a long name
            raise UsageError(f"{OPTION} {shown(str(folder))}: there is no such folder")
    real = real_target(output_dir)
    if output is None and output_dir.is_symlink():
        hint = f"--output-dir {shlex.quote(str(output_dir))} allows writing there"
        raise FileError(f"cannot write to {output_dir}: it is a link to {real}; {hint}")
    own = Path(os.path.realpath(place.folder))
    is_given = own == Path("/dev") or own.is_relative_to("/proc")  # on standard input
    return output_dir, WriteRules(
        folders=(real,) if is_given else (own, real),
        allowed=tuple(Path(os.path.realpath(folder)) for folder in allowed),
        given=frozenset(setting.node for setting in settings if setting.name == "path"),
        record=read_record(place.path),
    )


def _place(network: Path) -> Path:
    name = hashlib.sha256(os.fsencode(network)).hexdigest()[:32]
    return FOLDERS.user_state_path / "writes" / f"{name}.json"
