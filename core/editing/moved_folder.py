"""File names in a network that is saved into another folder."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path

from core.editing.fields import set_parameter
from core.editing.operation import Operation, Together
from core.modules.declaration import declaration
from core.modules.library_type import Library
from core.network.network import Network


def rebased(
    network: Network,
    library: Library,
    old_folder: Path,
    new_folder: Path,
    *,
    typed: Collection[tuple[str, str]] = (),
) -> Operation | None:
    """Make relative file names point at the same files from another folder; None if they do.

    Only of modules in the library is it known which parameters are file names.

    Parameters
    ----------
    network, library
        What is saved.
    old_folder, new_folder : Path
        What its file names are relative to, and shall be. They need not exist.
    typed : collection of (str, str)
        Nodes and parameters whose full names become relative below the new folder.
    """
    old, new = (Path(os.path.realpath(folder)) for folder in (old_folder, new_folder))
    if old == new and not typed:
        return None
    steps: list[Operation] = []
    for node in network.nodes.values():
        if node.module not in library:
            continue
        for parameter in declaration(library[node.module]).parameters:
            value = node.params.get(parameter.name)
            if parameter.kind != "path" or not isinstance(value, str):
                continue
            moves = _relative(value) and old != new
            if moves or ((node.id, parameter.name) in typed and _is_below(value, new)):
                moved = _from(old / value, new)
                if moved != value:
                    steps.append(set_parameter(node.id, parameter.name, moved))
    return Together(steps, "Keep file names") if steps else None


def _relative(value: str) -> bool:
    return bool(value) and "\0" not in value and not Path(value).is_absolute()


def _is_below(value: str, folder: Path) -> bool:
    file = Path(value)
    return file.is_absolute() and Path(os.path.realpath(file.parent)).is_relative_to(folder)


def _from(file: Path, folder: Path) -> str:
    """The file's name from a folder: relative, or in full where there is no way between them."""
    # The last part is kept: a name that is a link to a file stays that name.
    place = Path(os.path.realpath(file.parent), file.name) if file.name != ".." else file
    try:
        return Path(os.path.relpath(place, folder)).as_posix()
    except ValueError:  # another drive
        return place.as_posix()
