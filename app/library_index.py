"""What every module declares, kept in the cache: to list modules, none of their files is loaded."""

import io
import os
import pickle
import sys
from collections.abc import Iterator
from typing import Any

import core
import nodes
from app.user_folders import FOLDERS
from core.errors import FileError
from core.modules.declaration import Declaration, Library, declaration
from core.records import is_dataclass
from nodes.library import OURS, standard_library

_FILE = "declarations.pickle"


def declarations(library: Library) -> dict[str, Declaration]:
    """The declaration of every module, by key.

    Ours are read from the cache if no file of the engine or of a module has changed since; else
    they are derived, and kept there for the next time where that is possible.
    """
    is_ours = library is standard_library()
    known = _kept() if is_ours else {}
    found = {key: known.get(key) or declaration(library[key]) for key in library}
    if is_ours and not known:
        _keep({key: found[key] for key in OURS})
    return found


def _kept() -> dict[str, Declaration]:
    try:
        content = (FOLDERS.user_cache_path / _FILE).read_bytes()
        stamp, known = _Unpickler(io.BytesIO(content)).load()
        return dict(known) if stamp == _stamp() else {}
    except Exception:  # whatever a file that is damaged, or not ours, may raise
        return {}


def _keep(declared: dict[str, Declaration]) -> None:
    from core.atomic import write_bytes  # only where they are kept anew

    try:
        FOLDERS.user_cache_path.mkdir(parents=True, exist_ok=True)
        write_bytes(FOLDERS.user_cache_path / _FILE, pickle.dumps((_stamp(), declared)))
    except (OSError, FileError):  # it is made again next time
        pass


class _Unpickler(pickle.Unpickler):
    """Makes what a declaration consists of, and nothing else that a file may name."""

    def find_class(self, module: str, name: str) -> Any:
        found = super().find_class(module, name) if module.startswith("core.modules.") else None
        if not is_dataclass(found) or found.__module__ != module:
            raise pickle.UnpicklingError(f"{module}.{name} is not part of a declaration")
        return found


def _stamp() -> tuple[Any, ...]:
    files = [entry for room in (core, nodes) for entry in _python_files(room.__path__[0])]
    return (sys.version, sorted(files))


def _python_files(folder: str) -> Iterator[tuple[str, int, int]]:
    for entry in os.scandir(folder):
        if entry.is_dir():
            yield from _python_files(entry.path)
        elif entry.name.endswith(".py"):
            about = entry.stat()
            yield (entry.path, about.st_mtime_ns, about.st_size)
