"""Writing a chain to a network file, with the arrays of its scenes beside it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from core.editing.fields import set_parameter
from core.editing.moved_folder import rebased
from core.editing.operation import ABSENT
from core.errors import FileError
from core.modules.library_type import Library
from core.network.file import format_network, parse_network, save_network
from core.network.network import Network
from nodes.files.arrays import mapped_npy, write_npy
from nodes.input_output.held_samples import HeldSamples

_PLAIN = re.compile(r"[^\w.-]+")


def saved(
    network: Network,
    library: Library,
    folder: Path,
    target: Path,
    samples: Mapping[str, HeldSamples],
) -> Network:
    """Write a network and its arrays; gives the network as it was written.

    Parameters
    ----------
    network, library
        What is written.
    folder : Path
        What its file names are relative to so far.
    target : Path
        The network file.
    samples : mapping
        Samples by node.

    Raises
    ------
    FileError
        If a file cannot be written, or a file of an array's name holds something else and is not
        this network's.
    """
    own = _arrays_of(target, library)
    names = {node: f"{target.stem}_{_PLAIN.sub('_', node)}.npy" for node in samples}
    for node, name in names.items():
        network = set_parameter(node, "path", ABSENT).apply(network)
        _refuse_anothers(target.parent / name, samples[node], own)
    moved = rebased(network, library, folder, target.parent)
    if moved is not None:
        network = moved.apply(network)
    for node, name in names.items():
        network = set_parameter(node, "path", name).apply(network)
    text = format_network(network, library=library)
    parse_network(text, library=library, name_of_source=str(target))
    for node, name in names.items():
        write_npy(target.parent / name, samples[node].samples)
    save_network(network, target, library=library)
    return network


def _arrays_of(target: Path, library: Library) -> set[str]:
    """Names of the files that the network file of now names, where there is a sound one."""
    try:
        text = target.read_text(encoding="utf-8")
        network = parse_network(text, library=library, name_of_source=str(target))
    except Exception:  # there is none, or it is no network: then it names nothing
        return set()
    return {str(node.params.get("path")) for node in network.nodes.values()}


def _refuse_anothers(file: Path, held: HeldSamples, own: set[str]) -> None:
    if not file.exists() or file.name in own:
        return
    same = False
    try:
        stored = mapped_npy(file)
        same = stored.dtype == held.samples.dtype and np.array_equal(stored, held.samples)
    except FileError:
        pass
    if not same:
        raise FileError(
            f"{file} is there already and holds something else: save under another name, or "
            "remove it"
        )
