"""Finding a network: a file, or one that comes with the program."""

import shlex
from pathlib import Path

import networks
from core.errors import FileError, alike, shown, shown_path
from core.records import dataclass
from nodes.files.file_format import JSON


@dataclass(frozen=True)
class Place:
    path: Path
    name: str

    @property
    def folder(self) -> Path:
        """What `path` parameters are relative to."""
        return self.path.parent


def shipped_networks() -> dict[str, Path]:
    return _networks("*.json")


def published_networks() -> dict[str, Path]:
    """Cameras from data sheets and papers, by name: found as the examples are, but not listed."""
    return _networks("published/*.json")


def every_network() -> dict[str, Path]:
    return {**published_networks(), **shipped_networks()}


def _networks(pattern: str) -> dict[str, Path]:
    folder = Path(networks.__path__[0])
    return {path.stem: path for path in sorted(folder.glob(pattern))}


def find_network(text: str) -> Place:
    if not text:
        raise FileError("'' is not a network: give a file, or the name of an example network")
    path = Path(text)
    is_there = _is_there(path)
    if _is_picture(path) and not (path.is_file() and _holds_json(path)):
        what = "a picture, not a network" if is_there else "there is no such file"
        scene = shlex.quote(text)
        raise FileError(
            f"{shown_path(text)}: {what}; to send a picture through a camera: "
            f"imagechain run mwir_camera --scene {scene}"
        )
    if is_there and not path.is_dir():
        return Place(path, path.stem or path.name)
    every = every_network()
    if text in every:
        return Place(every[text], text)
    if is_there:
        raise FileError(f"{shown_path(text)}: a folder, not a network file")
    if text in _networks("presets/*.json"):
        raise FileError(
            f"{text} is a preset (part of a chain), not a network: in Python, add "
            f"ic.preset({text!r}) after a scene; in the editor, take it from the library"
        )
    hint = alike(text, every) or f"; example networks: {', '.join(shipped_networks()) or 'none'}"
    raise FileError(
        f"{shown_path(text)} is neither a file nor the name of an example network{hint}"
    )


def _is_picture(path: Path) -> bool:
    if path.suffix in ("", *JSON.suffixes):
        return False
    from nodes.files.formats import PICTURES  # which takes numpy to load

    return any(picture_format.matches(path) for picture_format in PICTURES)


def _holds_json(path: Path) -> bool:
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
