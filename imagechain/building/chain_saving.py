"""Write a chain to a network file, with the arrays of its scenes beside it."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.atomic import atomic_file, write_text
from core.editing.document import rebased
from core.editing.operations import ABSENT, set_parameter
from core.errors import FileError
from core.modules.declaration import Library
from core.network.file import format_network, save_network
from core.network.network import Network
from core.network.parsing import parse_network
from nodes.files.arrays import npy_header, whole_npy, write_npy
from nodes.files.frame_writing import FrameSeries, envi_header_text, header_beside_frames
from nodes.input_output.sample_unit import DEFAULT_UNIT
from nodes.input_output.source_file import HeldSamples

_PLAIN = re.compile(r"[^\w.-]+")


def saved(
    network: Network,
    library: Library,
    folder: Path,
    target: Path,
    samples: Mapping[str, HeldSamples],
    given: Collection[tuple[str, str]],
) -> Network:
    """Write a network and its arrays; returns the network as written.

    Its file names are relative to `folder` until then; `target` is the network file. `samples` are
    the arrays by node; `given` are the nodes and parameters whose file names were given in Python.

    Raises `FileError` if a file cannot be written, or if an array's file exists, holds something
    else and is not this network's.
    """
    own = _arrays_of(target, library)
    names = {
        node: f"{target.stem}_{_PLAIN.sub('_', node)}{'.npy' if _is_plain(held) else '.img'}"
        for node, held in samples.items()
    }
    for node, name in names.items():
        network = set_parameter(node, "path", ABSENT).apply(network)
        _refuse_anothers(target.parent / name, samples[node], own)
    moved = rebased(network, library, folder, target.parent, typed=given)
    if moved is not None:
        network = moved.apply(network)
    for node, name in names.items():
        network = set_parameter(node, "path", name).apply(network)
    text = format_network(network, library=library)
    parse_network(text, library=library, name_of_source=str(target))
    for node, name in names.items():
        unit = network.nodes[node].params.get("unit", DEFAULT_UNIT)
        _write(target.parent / name, samples[node], named=unit != DEFAULT_UNIT)
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
    try:
        same = _is_plain(held) and _holds(file, held.samples)
    except FileError:
        same = False
    if not same:
        raise FileError(
            f"{file} already exists and contains something else: save under another name, or "
            "remove it"
        )


def _holds(file: Path, samples: NDArray[Any]) -> bool:
    header = npy_header(file)
    same = header.dtype == samples.dtype and header.shape == samples.shape
    return same and np.array_equal(whole_npy(file), samples)


def _is_plain(held: HeldSamples) -> bool:
    return held.wavelengths_um is None


def _write(file: Path, held: HeldSamples, *, named: bool) -> None:
    """Write samples: a picture as ``.npy``, a cube as ENVI has it, with its header beside it.

    Where the network names no unit of a cube, the header does.
    """
    if _is_plain(held):
        write_npy(file, held.samples)
        return
    assert held.wavelengths_um is not None
    fields: dict[str, str | tuple[float, ...]] = {
        "wavelength_units": "Micrometers",
        "wavelength": held.wavelengths_um,
    }
    if not named:
        fields["unit"] = "W/m^2/sr/um"
    if held.widths_um is not None:
        fields["fwhm"] = held.widths_um
    dtype = held.samples.dtype.newbyteorder("<")
    bands, rows, columns = held.samples.shape
    series = FrameSeries(bands, rows, columns, dtype, fields, "bands")
    with atomic_file(file) as temporary, temporary.open("wb") as opened:
        opened.write(np.ascontiguousarray(held.samples, dtype).data)
    write_text(header_beside_frames(file), envi_header_text(series))
