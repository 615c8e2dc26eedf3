"""Bringing older network documents up to date."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from core.modules.declaration import Module, declaration
from core.network.network import Library, Link, Network, Node

Document = dict[str, Any]
Migration = Callable[[Document], Document]

# Append only: the first entry turns version 1 into 2, and so on. An entry gets a document of which
# only format and version have been checked, and leaves alone what is not as it expects.
MIGRATIONS: tuple[Migration, ...] = (
    dict,  # 2: a parameter may have an expression in the place of its value
)
VERSION = 1 + len(MIGRATIONS)


def least_version(network: Network) -> int:
    """The oldest version that can hold the network, so that older readers open all they can."""
    return 2 if any(node.linked for node in network.nodes.values()) else 1


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
    keys = _current_keys(library)
    nodes = {name: _node(node, keys, library) for name, node in network.nodes.items()}
    modules = {name: library.get(node.module) for name, node in nodes.items()}
    links = tuple(
        _link(link, modules.get(link.source), modules.get(link.target)) for link in network.links
    )
    if nodes == network.nodes and links == network.links:
        return network
    return replace(network, nodes=nodes, links=links)


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
    if source is not None and _renamed(source) and not declaration(source).output(link.output):
        new = _renamed(source).get(link.output, link.output)
        link = replace(link, output=new) if declaration(source).output(new) else link
    if target is not None and _renamed(target) and not declaration(target).input(link.input):
        new = _renamed(target).get(link.input, link.input)
        link = replace(link, input=new) if declaration(target).input(new) else link
    return link
