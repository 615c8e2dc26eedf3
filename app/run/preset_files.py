"""Presets: network files with one node; put into a network, they are copies."""

import json
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Any

import networks
from core.atomic import write_text
from core.editing.clipboard import as_new, pasted
from core.editing.document import rebased
from core.editing.layout import Point
from core.editing.operations import ABSENT, Operation, check_plain, set_parameter, together
from core.errors import FileError, ImagechainError, NetworkError, shown, thaw, writing
from core.modules.declaration import Declaration, Library, declaration
from core.modules.parameters import Parameter
from core.network import file
from core.network.linked_values import expression_text
from core.network.macro import face_of_macro
from core.network.network import Network, Node
from core.records import dataclass, replace

KEY = "preset:"
"""What the key of a preset begins with; no module's key has a colon."""

MOST_OWN = 500
_BARRED = '/\\:*?"<>|'


@dataclass(frozen=True)
class Preset:
    path: Path  # the file
    title: str
    text: str = ""
    own: bool = False  # whether the person saved it, and it does not come with the program
    problem: str = ""  # why it cannot be used; empty if it can
    body: Network | None = None  # its module, or the macro's inside; None where it cannot be used
    is_macro: bool = False

    @property
    def kind(self) -> str:
        """What part of a chain a shipped one is: its file's name begins with it."""
        return self.path.stem.partition("_")[0]

    @property
    def modules(self) -> tuple[str, ...]:
        nodes = () if self.body is None else self.body.nodes.values()
        return tuple(dict.fromkeys(node.module for node in nodes))

    @property
    def key(self) -> str:
        return f"{KEY}{'own' if self.own else 'shipped'}:{self.path.stem}"


def shipped_presets(library: Library) -> tuple[Preset, ...]:
    folder = Path(networks.__path__[0]) / "presets"
    return tuple(_preset(path, library, own=False) for path in sorted(folder.glob("*.json")))


def own_presets(folder: Path, library: Library) -> tuple[Preset, ...]:
    """Those in the folder of a person; a file that cannot be used is listed with its problem."""
    try:
        paths = sorted(path for path in folder.glob("*.json") if path.is_file())
    except OSError:
        paths = []
    return tuple(_preset(path, library, own=True) for path in paths[:MOST_OWN])


def placed(
    preset: Preset, network: Network, library: Library, at: Point | None, folder: Path | None = None
) -> tuple[str, Operation]:
    """A free name for the preset in a network that lies in `folder`, and what puts it there."""
    problem = _preset(preset.path, library, own=preset.own).problem  # it may have changed
    if problem:
        raise NetworkError(problem)
    one = file.read_network(preset.path, library=library)
    one = rebased(one, library, preset.path.parent, folder or preset.path.parent)
    text = file.format_network(one, library=library)
    (name,), operation = pasted(text, network, library, at)
    return name, operation


def save_preset(network: Network, name: str, folder: Path, library: Library) -> Path:
    node = network.node(name)
    if node.macro is None:
        raise NetworkError(f"{shown(name)} is not a macro: group nodes to make one (Ctrl+G)")
    for parameter in node.linked:
        raise NetworkError(
            f"{shown(name)}.{parameter} follows "
            f"{shown(expression_text(node.params[parameter]))}, so there is no value to save"
        )
    if any(letter in _BARRED for letter in node.id) or node.id.strip(" ") != node.id:
        raise NetworkError(f"{shown(name)} cannot be a file name: rename the node first")
    path = folder / f"{node.id}.json"
    with writing(shown(str(path))):
        folder.mkdir(parents=True, exist_ok=True)
        there = path.exists()
    if there:
        raise FileError(f"a preset {shown(node.id)} already exists ({path}): rename the node first")
    macro = as_new(node)
    assert macro.macro is not None
    macro = replace(macro, macro=replace(macro.macro, name=macro.macro.name or node.id))
    name, layout = macro.macro.name if macro.macro else node.id, {node.id: (0.0, 0.0)}
    file.save_network(
        Network(name=name, nodes={node.id: macro}, layout=layout), path, library=library
    )
    return path


Difference = tuple[str, Parameter, Any]
"""A node of a preset's inside, a parameter of it, and its value."""


def told_apart(presets: Iterable[Preset], library: Library) -> dict[str, list[Difference]]:
    """How presets differ from others of their module, or with the same inputs; by their keys."""
    found: dict[str, list[Difference]] = {}
    kinds: dict[Collection[str], list[Preset]] = {}
    for preset in presets:
        if preset.body is not None:
            alike = (
                frozenset(face_of_macro(preset.body).inputs) if preset.is_macro else preset.modules
            )
            kinds.setdefault(alike, []).append(preset)
    for siblings in kinds.values():
        inside = {preset.key: preset.body.nodes for preset in siblings if preset.body is not None}
        used = [
            (node.id, node.module, name)
            for nodes in inside.values()
            for node in nodes.values()
            for name in node.params
        ]
        for place, key, name in dict.fromkeys(used):
            declared = declaration(library[key]).parameter(name) if key in library else None
            if declared is None:
                continue
            values = {
                which: nodes[place].params.get(name, declared.default)
                for which, nodes in inside.items()
                if place in nodes and nodes[place].module == key
            }
            if any(value != next(iter(values.values())) for value in values.values()):
                for which, value in values.items():
                    found.setdefault(which, []).append((place, declared, value))
    return found


def preset_of(key: str, presets: Iterable[Preset]) -> Preset | None:
    return next((preset for preset in presets if preset.key == key), None)


def _preset(path: Path, library: Library, *, own: bool) -> Preset:
    try:
        network = file.read_unchanged(path, library=library)
        nodes = tuple(network.nodes.values())
        if len(nodes) != 1:
            raise NetworkError(f"{path}: not a preset; a preset is a network of one node")
    except ImagechainError as error:
        return Preset(path, path.stem, error.message, own, error.message)
    body = nodes[0].macro or network
    is_macro = nodes[0].macro is not None
    return Preset(path, body.name or nodes[0].id, body.description, own, "", body, is_macro)


# Named sets of a module's parameters, kept in the person's folder: one file a module.

FORMAT = "imagechain-parameters"
MOST = 200

Sets = dict[str, dict[str, Any]]


def sets_of(module: str, folder: Path) -> Sets:
    """The sets of a module by name, each as the params of a network file; none without a file."""
    path = _file(module, folder)
    if not path.exists():
        return {}
    document = file.read_json(file.read_text(path), str(path))
    if not isinstance(document, dict):
        document = {}
    sets = document.get("sets")
    of_kind = (document.get("format"), document.get("module")) == (FORMAT, module)
    if not (
        of_kind and isinstance(sets, dict) and all(isinstance(one, dict) for one in sets.values())
    ):
        raise NetworkError(f"{path}: contains no parameter sets for the module {shown(module)}")
    return dict(sets)


def save_set(name: str, node: Node, folder: Path) -> None:
    for parameter in node.linked:
        text = expression_text(node.params[parameter])
        raise NetworkError(
            f"{shown(parameter)} follows {shown(text)}, so there is no value to save", node=node.id
        )
    if not name.strip() or not name.isprintable():
        raise NetworkError(
            f"{name!r:.80} cannot be the name of saved parameters: a name must not be blank or "
            "contain control characters"
        )
    sets = sets_of(node.module, folder)
    if name not in sets and len(sets) >= MOST:
        raise NetworkError(
            f"this module already has {MOST} saved sets of parameters, the most allowed"
        )
    _write({**sets, name: thaw(node.params)}, node.module, folder)


def remove_set(name: str, module: str, folder: Path) -> None:
    sets = sets_of(module, folder)
    sets.pop(name, None)
    _write(sets, module, folder)


def given(
    name: str, values: Mapping[str, Any], node: Node, declared: Declaration, where: str
) -> Operation:
    """What gives a node the parameters of a set, and all others their defaults."""
    check_plain(values, name)
    steps: list[Operation] = []
    for key in {**values, **node.params}:
        parameter = declared.parameter(key)
        if key in values:
            if parameter is None:
                raise NetworkError(
                    f"the saved parameters {shown(name)} include {shown(key)}, but "
                    f"{declared.title} has no such parameter",
                    node=where,
                )
            parameter.coerce(values[key])
        value = values.get(key, ABSENT)
        if value is ABSENT and parameter is not None and parameter.required:
            continue
        if value is not ABSENT or key in node.params:
            steps.append(set_parameter(where, key, value))
    return together(steps, f"Set {where} to {name}")


def _file(module: str, folder: Path) -> Path:
    if not all(name.isidentifier() for name in module.split(".")):
        raise NetworkError(f"{shown(module)} is not a module whose parameters can be saved")
    return folder / f"{module}.json"


def _write(sets: Sets, module: str, folder: Path) -> None:
    document = {"format": FORMAT, "version": 1, "module": module, "sets": sets}
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)
    with writing(folder):
        folder.mkdir(parents=True, exist_ok=True)
    write_text(_file(module, folder), text + "\n")
