"""Making a drawn network valid, as a person would: by what the error says."""

import json
from pathlib import Path
from typing import Any

from app.run.evaluation import planned
from battery_settings import SMALL_PUPIL
from core.chain.engine import Engine
from core.errors import InputError, ParameterError
from core.evaluation.recipes import Store
from core.network.file import parse_network
from core.network.validation import NetworkProblems, check_network
from nodes.library import standard_library

Document = dict[str, Any]
MOST_STEPS = 60


def mended(document: Document, folder: Path) -> Document:
    """The document with what the errors name taken away: first a value, then all, then the node."""
    for _ in range(MOST_STEPS):
        # One step for each node named: the next round says what is still wrong.
        named = {e.node: e for e in faults(document, folder) if e.node in document["nodes"]}
        if not named:
            break
        for error in named.values():
            if error.node in document["nodes"]:
                _take_away(document, error)
    return document


def faults(document: Document, folder: Path) -> list[InputError]:
    """The faults of a network that show without computing it; of planning the first one."""
    library = standard_library()
    try:
        network = parse_network(json.dumps(document), library=library)
        check_network(network, library=library)
        # Nothing is computed, nor kept.
        planned(Engine(library, Store(0)), network, folder)
    except NetworkProblems as error:
        return [each for each in error.problems if isinstance(each, InputError)]
    except InputError as error:
        return [error]
    return []


def _take_away(document: Document, error: InputError) -> None:
    node = document["nodes"][error.node]
    params = node.get("params", {})
    if node["module"] == "exit_pupil" and params != SMALL_PUPIL:
        node["params"] = dict(SMALL_PUPIL)  # by default it is of a size that takes long
        return
    if isinstance(error, ParameterError) and params.pop(error.parameter, None) is not None:
        return
    if node.pop("disabled", False):
        return
    kept = {name: params[name] for name in ("path", "width", "height") if name in params}
    if len(kept) < len(params):
        node["params"] = kept
        return
    _remove(document, str(error.node))


def _remove(document: Document, name: str) -> None:
    """Take away a node, its links and what then lacks an input: the next errors name that."""
    del document["nodes"][name]
    document["links"] = [
        link for link in document["links"] if name not in (end.rpartition(".")[0] for end in link)
    ]
    if document.get("final", "").rpartition(".")[0] == name:
        del document["final"]
