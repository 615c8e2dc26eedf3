"""Network files that are read again and again: parsed once, until the file is another."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from core.modules.declaration import Library
from core.network.file import read_network
from core.network.network import Network

_MOST = 256  # files, of which a person's own presets are most

_Stamp = tuple[int, int, int]


class _SameLibrary:
    """A library as a key: it is compared by identity, since a mapping has no hash."""

    def __init__(self, library: Library) -> None:
        self.library = library

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _SameLibrary) and other.library is self.library

    def __hash__(self) -> int:
        return id(self.library)


def read_unchanged(path: Path, *, library: Library) -> Network:
    """As `read_network`; a file whose inode, size and time are as before is not read again.

    Every window lists all networks and presets that come with the program: to parse them takes
    longer than all else on its first page. What cannot be read is tried again the next time.

    Parameters
    ----------
    path : Path
        The file.
    library : mapping
        Modules by key, which are not to change.

    Raises
    ------
    FileError, NetworkError
        As `core.network.file.load_network`.
    """
    try:
        found = path.stat()
    except (OSError, ValueError):
        return read_network(path, library=library)  # which says in one line why it cannot
    stamp = (found.st_ino, found.st_size, found.st_mtime_ns)
    return _read(path, stamp, _SameLibrary(library))


@lru_cache(maxsize=_MOST)
def _read(path: Path, _stamp: _Stamp, same: _SameLibrary) -> Network:
    return read_network(path, library=same.library)
