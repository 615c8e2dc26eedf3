"""Turning a file into a document that can be worked on, without Qt."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from app.run.shipped import find_network, shipped_networks
from core.editing.document import Document, mark
from core.errors import ParameterError
from core.modules.declaration import Library, declaration, where_absent
from core.network.file import read_text
from core.network.macro import unfolded
from core.network.parsing import parse_network
from core.network.validation import NetworkProblems, problems

NETWORK_SUFFIX = ".json"


@dataclass(frozen=True)
class Opened:
    document: Document
    remark: str = ""


def open_network_file(path: Path, *, library: Library) -> Opened:
    """Read a network to work on.

    Unknown modules stay as placeholders and values that are not allowed stay on their nodes, to be
    mended there. Faults of the wiring, which no canvas could show, are refused.

    Raises
    ------
    FileError, NetworkError
        With one line on what is wrong.
    """
    text = read_text(path)
    network = parse_network(text, library=library, name_of_source=str(path))
    faults = problems(network, library=library, keep_unknown=True, unfinished=True)
    wiring = [problem for problem in faults if not isinstance(problem, ParameterError)]
    if wiring:
        raise NetworkProblems(wiring)
    document = Document(network, library=library, path=path, stored=mark(text.encode()))
    nodes = unfolded(network).nodes.values()
    modules = [node.module for node in nodes if node.macro is None and node.module not in library]
    remarks = []
    unknown = list(dict.fromkeys(modules))
    if unknown:
        names = ", ".join(unknown[:4]) + (" …" if len(unknown) > 4 else "")
        as_found = "it is" if len(unknown) == 1 else "they are"
        remarks.append(f"{_count(len(unknown), 'unknown module')} kept as {as_found}: {names}")
        reasons = (where_absent(module, library) for module in unknown[:4])
        remarks += dict.fromkeys(reason for reason in reasons if reason)
    if faults:
        remarks.append(f"{_count(len(faults), 'value')} not allowed: see the marked nodes")
    return Opened(document, "; ".join(remarks))


def open_named(text: str, *, library: Library) -> Opened:
    """A network by its path, or by its name where it is a shipped one.

    A shipped one opens as a copy without a path: saving needs a new one.
    """
    place = find_network(text)
    opened = open_network_file(place.path.absolute(), library=library)
    if place.path in shipped_networks().values():
        return Opened(shipped_copy(opened.document), opened.remark)
    return opened


def shipped_copy(document: Document) -> Document:
    """A shipped network as a new document; its own file is not to be written over.

    The files that are shipped with it are then named in full: it will be saved in another folder.
    """
    network, folder = document.network, document.folder
    for node in document.network.nodes.values():
        module = document.library.get(node.module)
        if module is None or declaration(module).sink:
            continue
        for parameter in declaration(module).parameters:
            path = node.params.get(parameter.name)
            if parameter.kind == "path" and isinstance(path, str) and (folder / path).is_file():
                full = str((folder / path).absolute())
                network = network.with_parameter(node.id, parameter.name, full)
    return Document(network, library=document.library)


def is_network_file(path: Path) -> bool:
    """Whether a dropped file is opened as a network, and not read as a picture."""
    return path.suffix.lower() == NETWORK_SUFFIX


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
