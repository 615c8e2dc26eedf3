"""Network files: reading, bringing up to date, writing; types and structure, not the meaning."""

import difflib
import json
import math
import re
import stat
from collections.abc import Callable, Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from core.atomic import write_text
from core.errors import (
    SCALARS,
    FileError,
    ImagechainError,
    NetworkError,
    ParameterError,
    check_id,
    shown,
    thaw,
)
from core.modules.declaration import Declaration, Library, Module, declaration
from core.modules.parameters import plain
from core.network.macro import End, checked_depth, declared_node, interface_of
from core.network.network import EXPRESSION, MACRO, NETWORK_FIELDS, NODE_FIELDS, Link, Network, Node
from core.network.validation import check_network
from core.records import replace

FORMAT = "imagechain-network"

_WORDS: dict[type, str] = {
    dict: "an object",
    list: "a list",
    str: "a string",
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    type(None): "null",
}


def parse_network(text: str, *, library: Library, name_of_source: str = "network") -> Network:
    """Read a network from the text of its file. It runs no code and reads no other file."""
    document = read_json(text, name_of_source)
    try:
        _expect(document, dict, "a network")
        document = migrate(document, _version(document))
        return with_current_names(_network(document), library)
    except ImagechainError as error:
        raise NetworkError(f"{name_of_source}: {error}") from None


def _version(document: dict[str, Any]) -> int:
    if document.get("format") != FORMAT:
        instead = f"not {document['format']!r:.80}" if "format" in document else "but none is given"
        raise NetworkError(f"not an Imagechain network: its format must be {FORMAT!r}, {instead}")
    version = _field(document, "version", int, "")
    if version < 1:
        raise NetworkError(f"version = {version} is not allowed: must be a whole number, 1 or more")
    if version > VERSION:
        raise NetworkError(
            f"version {version} is from a newer Imagechain; this Imagechain reads versions "
            f"up to {VERSION}"
        )
    return int(version)


def _network(document: dict[str, Any]) -> Network:
    graph = _graph(document, "", 0)
    return Network(
        name=_field(document, "name", str, "", ""),
        description=_field(document, "description", str, "", ""),
        seed=_field(document, "seed", int, "", 0),
        **graph(),
        extra=_others(document, NETWORK_FIELDS),
    )


_MACRO_FIELDS = ("title", "description", "nodes", "links", "layout")


def _read_macro(value: Any, where: str, level: int) -> Network:
    """The inside of a macro: the fields of a network, and what it shows of them."""
    checked_depth(level, where)
    _expect(value, dict, where)
    graph, extra = _graph(value, where, level), _others(value, _MACRO_FIELDS)
    interface_of(extra, where)
    name = _field(value, "title", str, where, "")
    description = _field(value, "description", str, where, "")
    return Network(name, description, **graph(), extra=extra)


def _graph(value: dict[str, Any], where: str, level: int) -> Callable[[], dict[str, Any]]:
    """What reads nodes, links and layout, once all fields around them are as they must be."""
    nodes = _field(value, "nodes", dict, where)
    links = _field(value, "links", list, where, [])
    layout = _field(value, "layout", dict, where, {})
    head, link_head = (f"{where}.", f"{where}, ") if where else ("", "")
    return lambda: {
        "nodes": {
            name: _read_node(name, node, f"{head}nodes.{name}", level)
            for name, node in nodes.items()
        },
        "links": tuple(
            _link(f"{link_head}link {number}", link) for number, link in enumerate(links, 1)
        ),
        "layout": {name: _point(name, point, f"{head}layout") for name, point in layout.items()},
    }


def _read_node(name: str, value: Any, where: str, level: int) -> Node:
    check_id(name)
    _expect(value, dict, where)
    for other in _others(value, NODE_FIELDS):
        # Unknown fields are kept, but a slip here would silently run with the defaults.
        meant = difflib.get_close_matches(other, ("params", "disabled", "final"), n=1, cutoff=0.75)
        if meant and len(other) <= 64:
            raise NetworkError(f"{where} has a field {shown(other)}; did you mean {meant[0]}?")
    module = _field(value, "module", str, where)
    if not module:
        raise NetworkError(f"{where}.module must not be empty")
    if (module == MACRO) != ("macro" in value):
        fault = f"is not a {MACRO} but has a field macro"
        if module == MACRO:
            fault = f"has the module {MACRO} but no field macro"
        raise NetworkError(f"{where} {fault}")
    return Node(
        id=name,
        module=module,
        params=_field(value, "params", dict, where, {}),
        auto=_field(value, "auto", bool, where) if "auto" in value else None,
        disabled=_field(value, "disabled", bool, where, False),
        final=_field(value, "final", bool, where, False),
        noise=_field(value, "noise", str, where, ""),
        macro=_read_macro(value["macro"], f"{where}.macro", level + 1)
        if "macro" in value
        else None,
        extra=_others(value, NODE_FIELDS),
    )


def _link(where: str, value: Any) -> Link:
    _expect(value, list, where)
    if len(value) != 2 or not all(isinstance(end, str) for end in value):
        raise NetworkError(f'{where} must be two strings, ["NODE.PORT", "NODE.PORT"]')
    try:
        return Link.between(*value)
    except NetworkError as error:
        raise NetworkError(f"{where}: {error}") from None


def _point(name: str, value: Any, where: str) -> tuple[float, float]:
    good = isinstance(value, list) and len(value) == 2
    if not good or any(type(number) not in (int, float) for number in value):
        raise NetworkError(f"{where}.{shown(name)} must be two numbers, [x, y]")
    return value[0], value[1]


def _others(value: dict[str, Any], known: tuple[str, ...]) -> dict[str, Any]:
    return {name: item for name, item in value.items() if name not in known}


def _field(value: dict[str, Any], name: str, kind: type, where: str, default: Any = None) -> Any:
    place = f"{where}.{name}" if where else name
    if name in value:
        _expect(value[name], kind, place)
        return value[name]
    if default is None:
        raise NetworkError(f"{place} is missing: it must be {_WORDS[kind]}")
    return default


def _expect(value: Any, kind: type, where: str) -> None:
    # Not isinstance: to Python, true is a whole number.
    if type(value) is not kind:
        word = _WORDS[bool] if isinstance(value, bool) else _WORDS[type(value)]
        raise NetworkError(f"{where} must be {_WORDS[kind]}, not {word}")


# Strict JSON, for documents that are mailed round and edited by hand.

LARGEST = 16 * 2**20  # characters; a network of a thousand nodes has about half a million
DEEPEST = 64
_STRING = re.compile(r'"[^"\\]*(?:\\.[^"\\]*)*"', re.DOTALL)
_BRACKET = re.compile(r"[\[\]{}]")


def read_json(text: str, source: str) -> Any:
    """Parse `text`.

    Other than Python's `json`: a key that comes twice, NaN, Infinity, numbers beyond double
    precision, half surrogate pairs, and hostile size and depth are refused.
    """
    if len(text) > LARGEST:
        raise NetworkError(f"{source}: larger than {LARGEST >> 20} MiB, the limit for a network")
    try:
        depth = 0  # deep nesting is refused before parsing it can end the process on a small stack
        for bracket in _BRACKET.findall(_STRING.sub("", text)):
            depth += 1 if bracket in "[{" else -1
            if depth > DEEPEST:
                raise NetworkError(f"nested more than {DEEPEST} levels deep")
        data = json.loads(
            text.removeprefix("\ufeff"),
            object_pairs_hook=_object,
            parse_int=_integer,
            parse_float=_number,
            parse_constant=_constant,
        )
        json.dumps(data, ensure_ascii=False).encode()
    except UnicodeEncodeError as error:
        half = error.object[error.start]
        raise NetworkError(f"{source}: {half!r} is not valid Unicode text") from None
    except json.JSONDecodeError as error:
        place = f"line {error.lineno}, column {error.colno}"
        raise NetworkError(f"{source}: not JSON: {error.msg} ({place})") from None
    except NetworkError as error:
        raise NetworkError(f"{source}: {error.message}") from None
    return data


def _object(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    fields = dict(pairs)
    if len(fields) < len(pairs):
        seen: set[str] = set()
        for name, _ in pairs:
            if name in seen:
                raise NetworkError(f"the key {shown(name)} occurs twice in one object")
            seen.add(name)
    return fields


def _integer(text: str) -> int:
    # Far below Python's limit of digits, whose error is none of ours.
    if len(text) > 300 and (len(text) > 310 or not math.isfinite(float(text))):
        raise NetworkError(f"a number of {len(text)} digits is too large")
    return int(text)


def _number(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise NetworkError(f"the number {shown(text)} is too large")
    return number


def _constant(text: str) -> float:
    raise NetworkError(f"{text} is not a valid JSON number")


# Bringing older network documents up to date.


Document = dict[str, Any]
Migration = Callable[[Document], Document]
Known = Callable[[Declaration, str], object]
"""The input, output or parameter of a name, if there is one."""

# Append only: the first entry turns version 1 into 2, and so on. An entry gets a document of which
# only format and version have been checked, and leaves alone what is not as it expects.
MIGRATIONS: tuple[Migration, ...] = (
    dict,  # 2: a parameter may have an expression in the place of its value, a node a macro inside
)
VERSION = 1 + len(MIGRATIONS)


def migrate(
    document: Document, version: int, migrations: tuple[Migration, ...] = MIGRATIONS
) -> Document:
    for step in migrations[version - 1 :]:
        document = step(document)
    return document


def with_current_names(network: Network, library: Library) -> Network:
    """Use the names the library has now for modules, parameters and ports.

    A module lists its earlier keys in `replaces`, and in a mapping `renamed` (old name: new name)
    those of its parameters and ports. A name that is still in use, or whose new name is taken,
    stays.
    """
    keys: dict[str, str] = {}
    if not all(node.macro or node.module in library for node in network.nodes.values()):
        for key, module in library.items():  # only then: to know old keys every one is loaded
            keys |= {old: keys.get(old, key) for old in module.replaces if old not in library}
    nodes = {name: _with_current(node, keys, library) for name, node in network.nodes.items()}
    modules = {name: library.get(node.module) for name, node in nodes.items()}
    links = tuple(
        Link(
            *_new_name(modules, (link.source, link.output), Declaration.output),
            *_new_name(modules, (link.target, link.input), Declaration.input),
        )
        for link in network.links
    )
    if nodes == network.nodes and links == network.links:
        return network
    return replace(network, nodes=nodes, links=links)


def _with_current(node: Node, keys: Mapping[str, str], library: Library) -> Node:
    if node.macro is not None:
        return replace(node, macro=_body_with_current(node.macro, library))
    if node.module in keys:
        node = replace(node, module=keys[node.module])
    modules = {node.id: library.get(node.module)}
    params = {}
    for name, value in node.params.items():
        _, new = _new_name(modules, (node.id, name), Declaration.parameter)
        params[name if new in node.params else new] = value
    return replace(node, params=params) if params.keys() != node.params.keys() else node


def _body_with_current(body: Network, library: Library) -> Network:
    body = with_current_names(body, library)
    modules = {name: library.get(inner.module) for name, inner in body.nodes.items()}
    try:
        face = interface_of(body.extra)
    except NetworkError:  # reported where the network is checked
        return body
    new = face.mapped(
        *(
            lambda end, known=known: (_new_name(modules, end, known),)
            for known in (Declaration.input, Declaration.output, Declaration.parameter)
        )
    )
    return body if new == face else replace(body, extra={**body.extra, **new.fields()})


def _new_name(modules: Mapping[str, type[Module] | None], end: End, known: Known) -> End:
    module = modules.get(end[0])
    new = getattr(module, "renamed", {}).get(end[1])
    if module is None or new is None or known(declaration(module), end[1]):
        return end
    return (end[0], new) if known(declaration(module), new) else end


# Network files: opening, writing out so that diffs read well, and saving in one step.


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
    known = _READ.get(path)
    if known is None or known[0] is not library or known[1] != stamp:
        known = _READ[path] = library, stamp, read_network(path, library=library)
    return known[2]


_READ: dict[Path, tuple[Library, tuple[int, ...], Network]] = {}


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
    nodes = network.nodes.values()
    newer = any(node.linked or node.macro is not None or node.noise for node in nodes)
    document: dict[str, Any] = {"format": FORMAT, "version": 2 if newer else 1}
    document["name"] = network.name
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
        placed = [name for name in network.nodes if name in network.layout]
        placed += sorted(network.layout.keys() - network.nodes.keys())
        fields["layout"] = {name: list(map(_short, network.layout[name])) for name in placed}
    return fields | dict(sorted(network.extra.items()))


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
        params = sorted(node.params.items())
        fields["params"] = {name: _canonical(declared, name, value) for name, value in params}
    if node.auto is not None:
        fields["auto"] = node.auto
    others = {"disabled": node.disabled, "final": node.final, "noise": node.noise}
    fields |= {name: value for name, value in others.items() if value}
    if node.macro is not None:
        texts = {"title": node.macro.name, "description": node.macro.description}
        given = {name: text for name, text in texts.items() if text}
        fields["macro"] = given | _inside(node.macro, library)
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
        network.links, key=lambda link: (place.get(link.target, last), place.get(link.source, last))
    )
    return [link.text() for link in links]


def _short(number: float) -> float:
    return int(number) if abs(number) < 2**53 and number == int(number) else number
