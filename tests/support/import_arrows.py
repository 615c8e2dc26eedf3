"""Imports between files and between folders of the product, read from its source."""

import ast
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from child_process import ROOT

LAYERS = ("core", "nodes", "app", "imagechain")
ENTRY = "__main__.py"  # nothing imports it: it stands above everything, wherever it lies


@cache
def modules() -> dict[str, Path]:
    """Dotted name of every module of the product, with its file."""
    found = {}
    for layer in LAYERS:
        for path in sorted((ROOT / layer).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def file_arrows() -> dict[str, frozenset[str]]:
    """For every module the modules of the product that it imports, wherever in the file."""
    known = modules()
    arrows = {}
    for name, path in known.items():
        wanted = set()
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                wanted |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                for alias in node.names:
                    inner = f"{node.module}.{alias.name}"
                    wanted.add(inner if inner in known else node.module)
        arrows[name] = frozenset(wanted & known.keys() - {name})
    return arrows


def folder_arrows() -> dict[str, dict[str, str]]:
    """For every folder the folders that it imports from, each with one import as an example."""
    arrows: dict[str, dict[str, str]] = {}
    for name, wanted in file_arrows().items():
        if modules()[name].name == ENTRY:
            continue
        for other in sorted(wanted):
            here, there = _folder(name), _folder(other)
            if here != there:
                arrows.setdefault(here, {}).setdefault(there, f"{name} imports {other}")
    return arrows


def _folder(name: str) -> str:
    return name if modules()[name].name == "__init__.py" else name.rpartition(".")[0]


def circles(arrows: Mapping[str, object]) -> list[list[str]]:
    """Sets of two or more names that reach one another (Tarjan 1972)."""
    order: dict[str, int] = {}
    lowest: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []
    for start in arrows:
        path = [] if start in order else [(start, iter(()), True)]
        while path:
            name, coming, is_new = path.pop()
            if is_new:
                order[name] = lowest[name] = len(order)
                stack.append(name)
                coming = iter(arrows.get(name, ()))  # type: ignore[call-overload]
            for other in coming:
                if other not in order:
                    path += [(name, coming, False), (other, iter(()), True)]
                    break
                if other in stack:
                    lowest[name] = min(lowest[name], order[other])
            else:
                if lowest[name] == order[name]:
                    place = stack.index(name)
                    if len(stack) - place > 1:
                        found.append(sorted(stack[place:]))
                    del stack[place:]
                if path:
                    above = path[-1][0]
                    lowest[above] = min(lowest[above], lowest[name])
    return found
