"""Network files: opening, writing out so that diffs read well, and saving in one step."""

import json
import math
import stat
from collections.abc import Mapping
from functools import lru_cache
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from core.atomic import write_text
from core.errors import FileError, NetworkError, ParameterError
from core.modules.declaration import Declaration, Library
from core.modules.parameters import plain
from core.names import SCALARS, thaw
from core.network.macro import declared_node
from core.network.network import EXPRESSION, Network, Node
from core.network.parsing import FORMAT, LARGEST, least_version, parse_network
from core.network.validation import check_network


def load_network(
    path: str | PathLike[str],
    *,
    library: Library,
    keep_unknown: bool = False,
    unfinished: bool = False,
) -> Network:
    """Open a network file: all of it, or an error. It runs no code and reads no other file."""
    network = read_network(path, library=library)
    check_network(network, library=library, keep_unknown=keep_unknown, unfinished=unfinished)
    return network


def read_network(path: str | PathLike[str], *, library: Library) -> Network:
    """Open a network file without checking it against the library; errors as `load_network`."""
    return parse_network(read_text(path), library=library, name_of_source=fspath(path))


def read_unchanged(path: Path, *, library: Library) -> Network:
    """As `read_network`; a file whose inode, size and time are as before is not read again.

    Every window lists all networks and presets that come with the program: to parse them takes
    longer than all else on its first page. What cannot be read is tried again the next time.
    """
    try:
        found = path.stat()
    except (OSError, ValueError):
        return read_network(path, library=library)  # which says in one line why it cannot
    stamp = found.st_ino, found.st_size, found.st_mtime_ns
    return _read(path, stamp, _SameLibrary(library))


class _SameLibrary:
    """A library as a key: it is compared by identity, since a mapping has no hash."""

    def __init__(self, library: Library) -> None:
        self.library = library

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _SameLibrary) and other.library is self.library

    def __hash__(self) -> int:
        return id(self.library)


@lru_cache(maxsize=256)  # files, of which a person's own presets are most
def _read(path: Path, _stamp: tuple[int, int, int], same: _SameLibrary) -> Network:
    return read_network(path, library=same.library)


def read_text(path: str | PathLike[str]) -> str:
    """The text of a network file, whatever it holds; errors as `load_network`."""
    try:
        # Opening a pipe would wait, reading a device never end.
        if not stat.S_ISREG(Path(path).stat().st_mode):
            raise FileError(f"cannot read {path}: it is not a regular file")
        with Path(path).open("rb") as file:
            content = file.read(LARGEST + 1)
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from None
    except ValueError:
        raise FileError(f"cannot read {fspath(path)!r}: not a valid file name") from None
    if len(content) > LARGEST:
        raise NetworkError(f"{path}: larger than {LARGEST >> 20} MiB, the limit for a network file")
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        raise NetworkError(f"{path}: not UTF-8 text (byte {error.start + 1})") from None


def save_network(network: Network, path: str | PathLike[str], *, library: Library) -> str:
    """Write a network to a file, which is the old one or the new one, never half of each."""
    text = format_network(network, library=library)
    # Never put in the place of a good file what could not be opened again.
    parse_network(text, library=library, name_of_source=fspath(path))
    write_text(path, text)
    return text


def format_network(network: Network, *, library: Library) -> str:
    """The text of a network file, of the oldest version that holds it all.

    Nodes keep their order, links follow it; all else whose order means nothing is sorted. Points,
    links, expressions and lists of numbers take one line each.
    """
    version = least_version(network)
    document: dict[str, Any] = {"format": FORMAT, "version": version, "name": network.name}
    if network.description:
        document["description"] = network.description
    document["seed"] = network.seed
    document |= _inside(network, library)
    encode = json.JSONEncoder(ensure_ascii=False, allow_nan=False).encode
    try:
        text = _lines(document, "\n", encode) + "\n"
        text.encode()
    except (TypeError, ValueError) as error:
        raise NetworkError(f"the network cannot be written as JSON: {error}") from None
    return text


def _inside(network: Network, library: Library) -> dict[str, Any]:
    """What a network and the inside of a macro have alike."""
    fields: dict[str, Any] = {
        "nodes": {name: _node(node, library) for name, node in network.nodes.items()},
        "links": _links(network),
    }
    if network.layout:
        fields["layout"] = _layout(network)
    return fields | dict(sorted(network.extra.items()))


def _macro(body: Network, library: Library) -> dict[str, Any]:
    texts = {"title": body.name, "description": body.description}
    return {name: text for name, text in texts.items() if text} | _inside(body, library)


def _lines(value: Any, newline: str, encode: Any) -> str:
    if type(value) in SCALARS:
        # The same text as `encode` gives, which sets up a whole encoder for every number.
        plain_number = type(value) is int or (type(value) is float and math.isfinite(value))
        return repr(value) if plain_number else str(encode(value))
    inner = newline + "  "
    if isinstance(value, Mapping) and value and value.keys() != {EXPRESSION}:
        rows = [f"{encode(name)}: {_lines(item, inner, encode)}" for name, item in value.items()]
        return "{" + inner + f",{inner}".join(rows) + newline + "}"
    if isinstance(value, list | tuple) and any(
        isinstance(v, list | tuple | Mapping) for v in value
    ):
        return (
            "[" + inner + f",{inner}".join(_lines(v, inner, encode) for v in value) + newline + "]"
        )
    return str(encode(thaw(value)))


def _node(node: Node, library: Library) -> dict[str, Any]:
    declared = declared_node(node, library) if node.params else None
    fields: dict[str, Any] = {"module": node.module}
    if node.params:
        given = sorted(node.params.items())
        fields["params"] = {name: _canonical(declared, name, value) for name, value in given}
    if node.auto is not None:
        fields["auto"] = node.auto
    if node.disabled:
        fields["disabled"] = True
    if node.final:
        fields["final"] = True
    if node.noise:
        fields["noise"] = node.noise
    if node.macro is not None:
        fields["macro"] = _macro(node.macro, library)
    return fields | dict(sorted(node.extra.items()))


def _canonical(declared: Declaration | None, name: str, value: Any) -> Any:
    """The value in its declared kind (1 → 1.0) where that is the same value."""
    parameter = declared.parameter(name) if declared is not None else None
    if parameter is None:
        return value
    try:
        coerced = plain(parameter.coerce(thaw(value)))
    except ParameterError:  # reported when the file is opened
        return value
    return coerced if coerced == thaw(value) else value


def _links(network: Network) -> list[list[str]]:
    place = {name: number for number, name in enumerate(network.nodes)}
    last = len(place)
    links = sorted(
        network.links,
        key=lambda link: (place.get(link.target, last), place.get(link.source, last)),
    )
    return [link.text() for link in links]


def _layout(network: Network) -> dict[str, list[float]]:
    placed = [name for name in network.nodes if name in network.layout]
    placed += sorted(network.layout.keys() - network.nodes.keys())
    return {name: [_short(number) for number in network.layout[name]] for name in placed}


def _short(number: float) -> float:
    return int(number) if abs(number) < 2**53 and number == int(number) else number
