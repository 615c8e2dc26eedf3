"""Finding a network: a file, or one that comes with the program."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path

import networks
from core.errors import FileError
from core.names import alike, shown, shown_path
from nodes.files.formats import PICTURES


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
        If there is neither, or the file is a picture.
    """
    if not text:
        raise FileError("'' is no network: give a file, or the name of a shipped one")
    path = Path(text)
    is_there = _is_there(path)
    named = any(picture_format.matches(path) for picture_format in PICTURES)
    if named and not (path.is_file() and _holds_json(path)):
        what = "is a picture, not a network" if is_there else "there is no such file"
        scene = shlex.quote(text)
        raise FileError(
            f"{shown_path(text)}: {what}; to send a picture through a camera: "
            f"imagechain run mwir_camera --scene {scene}"
        )
    if is_there and not path.is_dir():
        return Place(path, path.stem or path.name)
    shipped = shipped_networks()
    if text in shipped:
        return Place(shipped[text], text)
    if is_there:
        raise FileError(f"{shown_path(text)}: is a folder, not a network file")
    hint = alike(text, shipped) or f"; shipped are {', '.join(shipped) or 'none'}"
    raise FileError(f"{shown_path(text)} is neither a file nor the name of a shipped network{hint}")


def _holds_json(path: Path) -> bool:
    """Whether a file begins as a network does."""
    try:
        with path.open("rb") as file:
            return file.read(64).lstrip().startswith(b"{")
    except OSError:
        return False


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
