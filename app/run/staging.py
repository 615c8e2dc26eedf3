"""Output files that appear together at the end, or not at all."""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from core.atomic import FOLDER_PREFIX, LOCK, FileLock, new_mark, no_regular_file, sweep, take
from core.errors import FileError, ImagechainError
from nodes.files.common.file_format import ZARR
from nodes.files.store_folder import is_store

Writer = Callable[[Path], None]
Guard = Callable[[Path], None]


@dataclass(frozen=True)
class _Staged:
    file: Path
    target: Path
    given: Path


class Staging:
    """Collects files in hidden folders beside their targets; `commit` puts them in place.

    Whatever was not committed is gone at its end as a context manager. `folder` alone may be
    missing still; no output may replace one of the `inputs`.
    """

    def __init__(self, folder: Path | None, inputs: Iterable[Path] = ()) -> None:
        self._folder = None if folder is None else real_target(folder)
        self._inputs = {real_target(path) for path in inputs}
        self._claimed: dict[Path, Path] = {}  # by name, where links lead to
        self._staged: list[_Staged] = []
        self._guards: dict[Path, Guard] = {}
        self._places: dict[Path, Path] = {}
        self._locks: list[FileLock] = []
        self._swept: set[Path] = set()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for lock in self._locks:
            lock.let_go()
        for place in self._places.values():
            shutil.rmtree(place, ignore_errors=True)

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
        self._sweep(real.parent)
        self._claimed[target] = real

    def check(self, target: Path) -> None:
        real = real_target(target)
        if any(_overlap(real, path) for path in self._inputs):
            raise FileError(f"cannot write {target}: it is an input of this run")
        try:
            self._check_place(real, target)
        except OSError as error:
            raise _cannot(target, error) from error

    def _check_place(self, real: Path, target: Path) -> None:
        _check_existing(real, target)
        parent = real.parent
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
        if any(staged.target == real for staged in self._staged):
            raise FileError(f"cannot write: two outputs would be written to {target}")
        file = self._place(real, target) / f"{len(self._staged)}{real.suffix}"
        try:
            writer(file)
        except OSError as error:
            raise FileError(f"cannot write {target}: {error.strerror or error}") from error
        except ImagechainError as error:
            error.message = error.message.replace(str(file), str(target))
            raise
        self._staged.append(_Staged(file, real, target))

    def protect(self, path: Path) -> None:
        self._inputs.add(real_target(path))

    def drop(self, folder: Path) -> None:
        real = real_target(folder)
        self._staged = [file for file in self._staged if not file.target.is_relative_to(real)]
        for target, file in list(self._claimed.items()):
            if file.is_relative_to(real):
                del self._claimed[target]
                self._guards.pop(file, None)

    def guarded(self) -> list[tuple[Path, Path]]:
        """Targets that have a guard, links resolved, each with the file prepared for it."""
        return [
            (staged.target, staged.file) for staged in self._staged if staged.target in self._guards
        ]

    def commit(self) -> None:
        """Put every file in its place; if one fails, the others are as before."""
        for staged in self._staged:
            self._check_again(staged)
        undo: list[Callable[[], object]] = []
        target = self._folder or Path()
        try:
            for staged in self._staged:
                target = staged.given
                _make_folders(staged.target.parent, undo)
                _put(staged, undo)
        except OSError as error:
            _undo(undo)
            raise FileError(f"cannot write {target}: {error.strerror or error}") from error
        except BaseException:
            _undo(undo)
            raise

    def _check_again(self, staged: _Staged) -> None:
        self._check_way(staged.given)
        self.check(staged.given)
        guard = self._guards.get(staged.target)
        if guard is not None:
            guard(staged.given)

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
            place = folder / f"{FOLDER_PREFIX}{new_mark()}"
            try:
                place.mkdir()
                self._places[folder] = place
                lock = take(place / LOCK)
            except OSError as error:
                raise FileError(f"cannot write {target}: {error.strerror or error}") from error
            if lock is not None:
                self._locks.append(lock)
        return self._places[folder]

    def _sweep(self, parent: Path) -> None:
        """Clear away what killed runs have left where files of this one are prepared."""
        folder = _existing(parent)
        if folder not in self._swept:
            self._swept.add(folder)
            sweep(folder)


def existing_folder(folder: Path) -> Path:
    """A folder, or the nearest one above it that exists; links followed."""
    return _existing(real_target(folder))


def check_folder(folder: Path) -> None:
    try:
        status = folder.stat()
    except FileNotFoundError:  # it will be made
        above = _existing(real_target(folder))
        status = above.stat()
    except NotADirectoryError as error:
        reason = "part of its path is not a folder"
        raise FileError(f"cannot write to {folder}: {reason}") from error
    except OSError as error:
        raise _cannot(folder, error) from error
    else:
        above = folder
    if not stat.S_ISDIR(status.st_mode):
        raise FileError(f"cannot write to {folder}: it is not a folder")
    if not os.access(above, os.W_OK | os.X_OK):
        where = "" if above is folder else f" in {above}"
        raise FileError(f"cannot write to {folder}: no permission to write{where}")


def real_target(target: Path) -> Path:
    try:
        return Path(os.path.realpath(target))
    except OSError as error:
        raise _cannot(target, error) from error


def _cannot(target: Path, error: OSError) -> FileError:
    return FileError(f"cannot write to {target}: {error.strerror or error}")


def _check_existing(real: Path, target: Path) -> None:
    try:
        status = real.stat()
    except (FileNotFoundError, NotADirectoryError):
        return
    except OSError as error:
        raise FileError(f"cannot write {target}: {error.strerror or error}") from error
    unfit = no_regular_file(status.st_mode)
    if ZARR.matches(real):
        unfit = (
            ""
            if is_store(real)
            else ("a file that is not a Zarr store already has this name; choose another name")
        )
    if unfit:
        raise FileError(f"cannot write {target}: {unfit}")
    if not os.access(real, os.W_OK):
        raise FileError(f"cannot write {target}: the file is read-only")


def _overlap(real: Path, path: Path) -> bool:
    """Whether a file is the other, or one of a store and what lies in it."""
    if real == path or (ZARR.matches(real) and real in path.parents):
        return True
    return path in real.parents


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


def _put(staged: _Staged, undo: list[Callable[[], object]]) -> None:
    backup = staged.file.with_name(staged.file.name + ".old")
    if staged.file.is_dir():  # a store: one that is there makes room, and is gone with the stage
        if staged.target.exists():
            staged.target.replace(backup)
            undo.append(lambda: backup.replace(staged.target))
        undo.append(lambda: staged.target.replace(staged.file))
    elif staged.target.exists():
        shutil.copy2(staged.target, backup)
        staged.file.chmod(stat.S_IMODE(staged.target.stat().st_mode))
        undo.append(lambda: backup.replace(staged.target))
    else:
        undo.append(lambda: staged.target.unlink(missing_ok=True))
    staged.file.replace(staged.target)


def _undo(steps: list[Callable[[], object]]) -> None:
    for step in reversed(steps):
        # One that cannot be undone must not keep the rest from it.
        with contextlib.suppress(OSError):
            step()
