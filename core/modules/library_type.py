"""A library of modules, handed to the engine: keys to classes, old keys included.

The key of a module that a package of its own brings begins with that package's name and a dot:
``acme_optics.flare``. So a network says by itself which package it needs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType

from core.modules.declaration import Module

Library = Mapping[str, type[Module]]


class PackagedLibrary(dict[str, type[Module]]):
    """Modules by key, and packages of which some could not be loaded.

    Parameters
    ----------
    modules : mapping
        Modules by key.
    faults : mapping
        By package, why not all of its modules are there, in one line.
    """

    def __init__(self, modules: Library, faults: Mapping[str, str]) -> None:
        super().__init__(modules)
        self.faults = MappingProxyType(dict(faults))


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


def package_of(key: str) -> str:
    """The package that a module's key names; empty for a module of ours."""
    package, _, local = key.rpartition(".")
    names = (*package.split("."), local)
    return package if package and all(name.isidentifier() for name in names) else ""


def local_key(key: str) -> str:
    """A module's key without the name of its package."""
    return key[len(package_of(key)) :].removeprefix(".")


def where_absent(key: str, library: Library) -> str:
    """Why the library has no such module, if its key names the package it would be of."""
    package = package_of(key)
    if not package:
        return ""
    fault = library.faults.get(package) if isinstance(library, PackagedLibrary) else None
    if fault is not None:
        return f"it is of the package {package}, which is installed, but {fault}"
    if any(package_of(other) == package for other in library):
        return f"the package {package} is installed, and has no such module"
    return f"it is of the package {package}, which is not installed here"
