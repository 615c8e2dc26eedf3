"""A library of modules, handed to the engine: keys to classes, old keys included."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from core.modules.declaration import Module

Library = Mapping[str, type[Module]]


def library_of(modules: Iterable[type[Module]]) -> dict[str, type[Module]]:
    """Modules by key.

    Raises
    ------
    ValueError
        If two modules share a key.
    """
    library: dict[str, type[Module]] = {}
    for module in modules:
        if module.key in library or not module.key:
            raise ValueError(f"module key {module.key!r} is missing or taken twice")
        library[module.key] = module
    return library
