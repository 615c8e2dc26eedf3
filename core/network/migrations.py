"""Bringing older network documents up to date."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from core.errors import NetworkError
from core.modules.declaration import Declaration, Library, Module, declaration
from core.network.macro import End, interface_of
from core.network.network import Link, Network, Node

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


def least_version(network: Network) -> int:
    """The oldest version that can hold the network, so that older readers open all they can."""
    nodes = network.nodes.values()
    newer = any(node.linked or node.macro is not None or node.noise for node in nodes)
    return 2 if newer else 1


def migrate(
    document: Document, version: int, migrations: tuple[Migration, ...] = MIGRATIONS
) -> Document:
    """Turn a document of an older `version` into one of the newest."""
    for step in migrations[version - 1 :]:
        document = step(document)
    return document


def with_current_names(network: Network, library: Library) -> Network:
    """Use the names the library has now for modules, parameters and ports.

    A module lists its earlier keys in `replaces`, and in a mapping `renamed` (old name: new name)
    those of its parameters and ports. A name that is still in use, or whose new name is taken,
    stays.
    """
    # To know old keys every module is loaded: only where the library lacks one of these.
    known = all(node.macro or node.module in library for node in network.nodes.values())
    keys = {} if known else _current_keys(library)
    nodes = {name: _node(node, keys, library) for name, node in network.nodes.items()}
    nodes = {name: _inside(node, library) for name, node in nodes.items()}
    modules = {name: library.get(node.module) for name, node in nodes.items()}
    links = tuple(
        _link(link, modules.get(link.source), modules.get(link.target)) for link in network.links
    )
    if nodes == network.nodes and links == network.links:
        return network
    return replace(network, nodes=nodes, links=links)


def _inside(node: Node, library: Library) -> Node:
    """A macro with current names inside, and in what it shows of that."""
    if node.macro is None:
        return node
    body = with_current_names(node.macro, library)
    modules = {name: library.get(inner.module) for name, inner in body.nodes.items()}
    try:
        face = interface_of(body.extra)
    except NetworkError:  # reported where the network is checked
        return replace(node, macro=body)
    new = face.mapped(
        lambda end: (_new_name(end, modules.get(end[0]), Declaration.input),),
        lambda end: (_new_name(end, modules.get(end[0]), Declaration.output),),
        lambda end: (_new_name(end, modules.get(end[0]), Declaration.parameter),),
    )
    extra = body.extra if new == face else {**body.extra, **new.fields()}
    return replace(node, macro=replace(body, extra=extra))


def _new_name(end: End, module: type[Module] | None, known: Known) -> End:
    """A node and the name that its port or parameter has now."""
    renamed = {} if module is None else _renamed(module)
    if module is None or not renamed or known(declaration(module), end[1]):
        return end
    new = renamed.get(end[1], end[1])
    return (end[0], new) if known(declaration(module), new) else end


def _current_keys(library: Library) -> dict[str, str]:
    current: dict[str, str] = {}
    for key, module in library.items():
        for old in module.replaces:
            if old not in library:
                current.setdefault(old, key)
    return current


def _renamed(module: type[Module]) -> Mapping[str, str]:
    # Few modules have one, so it is no field of the declaration.
    return getattr(module, "renamed", {})


def _node(node: Node, keys: Mapping[str, str], library: Library) -> Node:
    if node.module in keys:
        node = replace(node, module=keys[node.module])
    module = library.get(node.module)
    renamed = {} if module is None else _renamed(module)
    if module is None or not renamed:
        return node
    declared = declaration(module)
    params = {}
    for name, value in node.params.items():
        new = renamed.get(name, name)
        stays = declared.parameter(name) or not declared.parameter(new) or new in node.params
        params[name if stays else new] = value
    return replace(node, params=params)


def _link(link: Link, source: type[Module] | None, target: type[Module] | None) -> Link:
    start = _new_name((link.source, link.output), source, Declaration.output)
    end = _new_name((link.target, link.input), target, Declaration.input)
    return Link(*start, *end)
