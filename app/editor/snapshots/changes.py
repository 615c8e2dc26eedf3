"""What has changed from one state of a network to another, in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, replace
from typing import Any

from app.editor.declared_text import label_of, shown_value
from core.errors import ParameterError
from core.modules.declaration import Declaration
from core.names import thaw
from core.network.linked_values import expression_text
from core.network.network import EXPRESSION, Network, Node

Declared = Callable[[Node], Declaration | None]
NOTHING = "as now"
MOST = 3


def changes(before: Network, after: Network, declared: Declared) -> tuple[str, ...]:
    """Each change in a few words, nodes first; none where the two are the same.

    Parameters
    ----------
    before, after : Network
        The two states.
    declared : callable
        Gives a node's declaration; None of an unknown module.
    """
    if before is after:
        return ()
    old, new = before.nodes, after.nodes
    names = _renamed(old, new)
    texts = [f"{one} renamed {other}" for one, other in names.items()]
    texts += [f"{name} added" for name in new if name not in old and name not in names.values()]
    texts += [f"{name} removed" for name in old if name not in new and name not in names]
    for name, node in old.items():
        now = new.get(names.get(name, name))
        if now is not None and now is not node:
            texts += _of_node(node, now, declared)
    texts += _wires(before, after, names)
    texts += _of_network(before, after)
    return tuple(texts)


def in_short(texts: tuple[str, ...]) -> str:
    """The first few, and how many more."""
    if not texts:
        return NOTHING
    more = len(texts) - MOST
    return "; ".join(texts[:MOST]) + (f"; and {more} more" if more > 0 else "")


def _renamed(old: Mapping[str, Node], new: Mapping[str, Node]) -> dict[str, str]:
    """New names of nodes that are the same otherwise, by their old ones."""
    come = [node for name, node in new.items() if name not in old]
    names: dict[str, str] = {}
    for name, node in old.items():
        if name not in new:
            same = (other for other in come if replace(other, id=name) == node)
            match = next((other for other in same if other.id not in names.values()), None)
            if match is not None:
                names[name] = match.id
    return names


def _of_node(old: Node, new: Node, declared: Declared) -> list[str]:
    name = new.id
    if old.module != new.module:
        return [f"{name} is another module"]
    declaration = declared(new)
    texts = []
    for key in dict.fromkeys((*old.params, *new.params)):
        one, other = (_text(declaration, key, node) for node in (old, new))
        if one != other:
            parameter = declaration.parameter(key) if declaration is not None else None
            unit = f" {parameter.param.unit}" if parameter and parameter.param.unit else ""
            label = label_of(key)
            texts.append(f"{name} {label} {one} → {other}{unit}")
    if old.disabled != new.disabled:
        texts.append(f"{name} {'disabled' if new.disabled else 'enabled'}")
    if (old.auto is False) != (new.auto is False):
        texts.append(f"{name} {'held' if new.auto is False else 'no longer held'}")
    if old.final != new.final:
        texts.append(f"{name} {'marked as the output' if new.final else 'no longer the output'}")
    if old.extra != new.extra and not texts:
        texts.append(f"{name} looks different")
    return texts


def _text(declaration: Declaration | None, key: str, node: Node) -> str:
    """A parameter's value as a person reads it, the default where it is left out."""
    parameter = declaration.parameter(key) if declaration is not None else None
    if key not in node.params:
        missing = parameter is None or parameter.default is MISSING
        return "default" if parameter is None or missing else _shown(parameter, parameter.default)
    value = node.params[key]
    if isinstance(value, Mapping) and EXPRESSION in value:
        return f"= {expression_text(value)}"
    plain = thaw(value)
    return f"{plain}" if parameter is None else _shown(parameter, plain)


def _shown(parameter: Any, value: Any) -> str:
    try:
        return shown_value(parameter, parameter.coerce(value))
    except (ParameterError, TypeError, ValueError):  # a value that is not allowed is shown, too
        return str(value)


def _wires(before: Network, after: Network, names: Mapping[str, str]) -> list[str]:
    """Wires made and taken away between nodes that both states have."""
    moved = {
        replace(
            link,
            source=names.get(link.source, link.source),
            target=names.get(link.target, link.target),
        )
        for link in before.links
    }
    both = {names.get(name, name) for name in before.nodes} & set(after.nodes)
    now = set(after.links)
    texts = []
    for word, links in (("wired", now - moved), ("no longer wired", moved - now)):
        texts += [f"{link} {word}" for link in sorted(links) if {link.source, link.target} <= both]
    return texts


def _of_network(before: Network, after: Network) -> list[str]:
    texts = []
    if before.seed != after.seed:
        texts.append(f"seed {before.seed} → {after.seed}")
    if before.name != after.name:
        texts.append("name of the network")
    if before.description != after.description:
        texts.append("description of the network")
    if before.extra != after.extra:
        texts.append("notes, backdrops or other fields")
    if any(after.layout.get(name, at) != at for name, at in before.layout.items()):
        texts.append("places on the canvas")
    return texts
