"""Named sets of a module's parameters, kept in the person's folder: one file a module."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.atomic import write_text
from core.editing.operations import ABSENT, Operation, Together, check_plain, set_parameter
from core.errors import FileError, NetworkError
from core.modules.declaration import Declaration
from core.names import shown, thaw
from core.network.file import read_text
from core.network.json_reading import read_json
from core.network.linked_values import expression_text
from core.network.network import Node

FORMAT = "imagechain-parameters"
MOST = 200

Sets = dict[str, dict[str, Any]]


def sets_of(module: str, folder: Path) -> Sets:
    """The sets of a module by name, each as the params of a network file; none without a file.

    Raises
    ------
    FileError, NetworkError
        If the file cannot be read, or is none of this kind.
    """
    path = _file(module, folder)
    if not path.exists():
        return {}
    document = read_json(read_text(path), str(path))
    if not isinstance(document, dict):
        document = {}
    sets = document.get("sets")
    of_kind = (document.get("format"), document.get("module")) == (FORMAT, module)
    if not of_kind or not isinstance(sets, dict) or not all(map(_is_set, sets.values())):
        raise NetworkError(f"{path}: no sets of parameters of the module {shown(module)}")
    return dict(sets)


def save_set(name: str, node: Node, folder: Path) -> None:
    """Keep a node's parameters under a name, in place of those that had it.

    Raises
    ------
    FileError, NetworkError
        If the file cannot be read or written, the name is blank, or a parameter follows others:
        they are of one network, and the set is for all.
    """
    for parameter in node.linked:
        text = expression_text(node.params[parameter])
        raise NetworkError(
            f"{shown(parameter)} follows {shown(text)}, which has no value to be kept", node=node.id
        )
    if not name.strip() or not name.isprintable():
        raise NetworkError(f"{name!r:.80} is no name of a set: it must not be blank")
    sets = sets_of(node.module, folder)
    if name not in sets and len(sets) >= MOST:
        raise NetworkError(f"there are {MOST} sets of this module already, which is the most")
    _write({**sets, name: thaw(node.params)}, node.module, folder)


def remove_set(name: str, module: str, folder: Path) -> None:
    """Forget a set; errors as `save_set`."""
    sets = sets_of(module, folder)
    sets.pop(name, None)
    _write(sets, module, folder)


def given(
    name: str, values: Mapping[str, Any], node: Node, declared: Declaration, where: str
) -> Operation:
    """What gives a node the parameters of a set, and all others their defaults.

    Parameters
    ----------
    name : str
        The set's name.
    values : mapping
        The set.
    node : Node
        The node as it is.
    declared : Declaration
        Its module.
    where : str
        The node's name in the whole network.

    Raises
    ------
    NetworkError, ParameterError
        If the module has no such parameter, or it does not take the value.
    """
    check_plain(values, name)
    steps: list[Operation] = []
    for key in {**values, **node.params}:
        parameter = declared.parameter(key)
        if key in values:
            if parameter is None:
                raise NetworkError(
                    f"the set {shown(name)} has a parameter {shown(key)} that {declared.title} has "
                    "not",
                    node=where,
                )
            parameter.coerce(values[key])
        value = values.get(key, ABSENT)
        if value is ABSENT and parameter is not None and parameter.required:
            continue
        if value is not ABSENT or key in node.params:
            steps.append(set_parameter(where, key, value))
    return Together(steps, f"Set {where} to {name}")


def _is_set(value: Any) -> bool:
    return isinstance(value, dict)


def _file(module: str, folder: Path) -> Path:
    if not all(name.isidentifier() for name in module.split(".")):
        raise NetworkError(f"{shown(module)} is no module whose parameters can be kept")
    return folder / f"{module}.json"


def _write(sets: Sets, module: str, folder: Path) -> None:
    document = {"format": FORMAT, "version": 1, "module": module, "sets": sets}
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot write {folder}: {error.strerror or error}") from None
    write_text(_file(module, folder), text + "\n")
