"""The handbook's files in a folder: of the user's choice, or the cache that is made when needed."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path

from app.handbook.contents import PAGES
from app.handbook.written_pages import TEMPLATES, handbook_files
from core.errors import FileError
from core.modules.declaration import declaration
from core.modules.library_type import Library

MARK = "handbook.json"
"""A file that only a handbook's folder has."""
_UNUSED_S = 30 * 24 * 3600.0
Progress = Callable[[str], None]


def cache_folder(
    environment: Mapping[str, str] | None = None, platform: str = sys.platform
) -> Path | None:
    """The user's folder for what can be made again; None where there is none.

    ``$XDG_CACHE_HOME/imagechain`` where that is set, else the system's usual place.
    """
    known = os.environ if environment is None else environment
    given = known.get("XDG_CACHE_HOME", "")
    if Path(given).is_absolute():
        return Path(given) / "imagechain"
    if platform == "win32":
        local = known.get("LOCALAPPDATA", "")
        return Path(local) / "imagechain" / "cache" if local else None
    home = known.get("HOME", "")
    if not Path(home).is_absolute():
        return None
    if platform == "darwin":
        return Path(home) / "Library" / "Caches" / "imagechain"
    return Path(home) / ".cache" / "imagechain"


def kept_handbook(library: Library, progress: Progress = lambda _: None) -> Path:
    """The handbook's folder in the cache; its pages are made if they are not those of today.

    Today's are those of this version, its pages and the modules there are, plug-ins too.

    Raises
    ------
    FileError
        If there is no such folder, or it cannot be written.
    """
    cache = cache_folder()
    if cache is None:
        raise FileError(
            "there is no folder for the handbook: set HOME or XDG_CACHE_HOME, "
            "or name one: imagechain handbook --html DIR"
        )
    folder = cache / f"handbook-{content_mark(library)}"
    if (folder / MARK).is_file():
        with suppress(OSError):
            os.utime(folder / MARK)
        return folder
    try:
        cache.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot make the folder {cache}: {error.strerror or error}") from error
    write_handbook(folder, library, progress)
    _remove_unused(cache, folder)
    return folder


def content_mark(library: Library) -> str:
    """A name that changes with whatever the pages are made of."""
    digest = hashlib.sha256()
    for folder in (PAGES, TEMPLATES):
        for path in sorted(folder.iterdir()):
            if path.is_file():
                digest.update(path.name.encode() + b"\0" + path.read_bytes())
    for module in library.values():
        digest.update(repr(declaration(module)).encode())
    for path in sorted(PAGES.parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def write_handbook(folder: Path, library: Library, progress: Progress = lambda _: None) -> None:
    """Write all pages to a folder: whole, or not at all.

    The folder is new, empty, or one with a handbook in it, which is replaced.

    Raises
    ------
    FileError
        If there is something else in the folder, or it cannot be written.
    """
    if folder.exists() and not _may_be_replaced(folder):
        raise FileError(
            f"cannot write the handbook to {folder}: it holds something else; name a new folder"
        )
    parent = folder.resolve().parent
    if not parent.is_dir():
        raise FileError(f"cannot write the handbook to {folder}: there is no folder {parent}")
    try:
        made = Path(tempfile.mkdtemp(prefix=".handbook-", dir=parent))
    except OSError as error:
        raise FileError(f"cannot write to {parent}: {error.strerror or error}") from error
    try:
        _fill(made, library, progress)
        _put_in_place(made, folder.resolve())
    except OSError as error:
        raise FileError(
            f"cannot write the handbook to {folder}: {error.strerror or error}"
        ) from error
    finally:
        shutil.rmtree(made, ignore_errors=True)


def _may_be_replaced(folder: Path) -> bool:
    return folder.is_dir() and ((folder / MARK).is_file() or not any(folder.iterdir()))


def _fill(made: Path, library: Library, progress: Progress) -> None:
    names = []
    for name, content in handbook_files(library, progress):
        file = made / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(content, encoding="utf-8", newline="\n")
        names.append(name)
    facts = {"format": "imagechain-handbook", "version": 1, "files": names}
    (made / MARK).write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
    made.chmod(0o755)


def _put_in_place(made: Path, folder: Path) -> None:
    """Give the folder its name; a handbook before it is out of the way for no longer than that."""
    aside = None
    if folder.exists():
        aside = made.with_name(made.name + "-before")
        folder.rename(aside)
    try:
        made.rename(folder)
    except OSError:
        if aside is not None:
            aside.rename(folder)
        if (folder / MARK).is_file():  # another process has just made it
            return
        raise
    finally:
        if aside is not None and folder.exists():
            shutil.rmtree(aside, ignore_errors=True)


def _remove_unused(cache: Path, used: Path) -> None:
    """Handbooks of versions that have not been opened for a month."""
    for old in cache.glob("handbook-*"):
        with suppress(OSError):
            if old != used and time.time() - (old / MARK).stat().st_mtime > _UNUSED_S:
                shutil.rmtree(old)
