"""Modules that other installed packages bring, by their entry points.

A package names them in its ``pyproject.toml``::

    [project.entry-points."imagechain.modules"]
    flare = "acme_optics.flare:Flare"

An entry point is a module's class, or several of them. Their keys begin with the package's name, as
Python writes it, and a dot: ``acme_optics.flare``.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from core.errors import in_line
from core.evaluation.float_guard import PLUG_INS, with_place
from core.modules.declaration import (
    Library,
    Module,
    PackagedLibrary,
    declaration,
    local_key,
    package_of,
)


@dataclass(frozen=True)
class PlugIns:
    """What installed packages bring: modules in the order of the packages' names.

    `faults` say by package why not all of its modules are there, in one line.
    """

    modules: tuple[type[Module], ...]
    faults: Mapping[str, str]


def installed_plug_ins(taken: Iterable[str] = ()) -> PlugIns:
    """Load the modules of every installed package that has some, but for keys that are `taken`.

    Whatever is wrong with a package keeps its modules out, and nobody else's.
    """
    modules: dict[str, type[Module]] = {}
    faults: dict[str, str] = {}
    known = set(taken)
    for point in sorted(entry_points(group=PLUG_INS), key=lambda one: (_package(one), one.name)):
        package = _package(point)
        try:
            for module in _modules_at(point, package):
                if module.key in known:
                    raise TypeError(f"two modules have the key {module.key}")
                known.add(module.key)
                modules[module.key] = module
        except (Exception, SystemExit) as error:  # whatever code of others may raise
            faults.setdefault(package, f"{point.value} cannot be loaded: {with_place(error)}")
    return PlugIns(tuple(modules.values()), faults)


def missing_modules(library: Library) -> list[str]:
    """One line for each installed package of which modules are missing."""
    faults = library.faults if isinstance(library, PackagedLibrary) else {}
    return [
        in_line(f"modules of the package {package} are missing: {fault}")
        for package, fault in faults.items()
    ]


def _package(point: EntryPoint) -> str:
    name = point.dist.name if point.dist is not None else point.module.partition(".")[0]
    return re.sub(r"[-_.]+", "_", name).lower()


def _modules_at(point: EntryPoint, package: str) -> tuple[type[Module], ...]:
    loaded: Any = point.load()
    if isinstance(loaded, Mapping):
        loaded = loaded.values()
    several = (loaded,) if isinstance(loaded, type) else tuple(loaded)
    for module in several:
        if not (isinstance(module, type) and issubclass(module, Module)):
            raise TypeError(f"{module!r:.80} is not a subclass of Module")
        local = local_key(module.key)
        if package_of(module.key) != package or not local.isidentifier():
            wanted = f"{package}.{local if local.isidentifier() else 'name'}"
            raise TypeError(
                f"the key of {module.__name__} is {module.key!r}, but must be {wanted!r}"
            )
        if not (module.title and module.group):
            raise TypeError(f"{module.__name__} has no title or no group")
        declaration(module)
    return several
