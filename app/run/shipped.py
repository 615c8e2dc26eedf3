"""Finding a network: a file, or one that comes with the program."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import networks
from core.errors import FileError
from core.names import close, shown, shown_path


@dataclass(frozen=True)
class Place:
    """Where a network lies, and what its outputs are named after."""

    path: Path
    name: str

    @property
    def folder(self) -> Path:
        """What `path` parameters are relative to."""
        return self.path.parent


def shipped_networks() -> dict[str, Path]:
    """Shipped networks by name."""
    folder = Path(networks.__path__[0])
    return {path.stem: path for path in sorted(folder.glob("*.json"))}


def find_network(text: str) -> Place:
    """The file of that path, else the shipped network of that name.

    Raises
    ------
    FileError
        If there is neither.
    """
    if not text:
        raise FileError("'' is no network: give a file, or the name of a shipped one")
    path = Path(text)
    if _is_there(path) and not path.is_dir():
        return Place(path, path.stem or path.name)
    shipped = shipped_networks()
    if text in shipped:
        return Place(shipped[text], text)
    if _is_there(path):
        raise FileError(f"{shown_path(text)}: is a folder, not a network file")
    hint = close(text, shipped) or f"; shipped are {', '.join(shipped) or 'none'}"
    raise FileError(f"{shown_path(text)} is neither a file nor the name of a shipped network{hint}")


def _is_there(path: Path) -> bool:
    try:
        path.stat()
    except FileNotFoundError:
        return False
    except OSError as error:
        raise FileError(f"cannot read {shown(str(path))}: {error.strerror or error}") from None
    except ValueError:
        return False
    return True
