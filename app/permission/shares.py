"""Files on other computers that a network names: opening one sends the user's name there."""

from __future__ import annotations

import os
from collections.abc import Collection
from pathlib import Path

from core.errors import NetworkError
from core.modules.declaration import declaration
from core.modules.library_type import Library
from core.names import shown
from core.network.network import Network

_DEVICES = ("\\\\?\\", "\\\\.\\", "\\??\\")


def share_server(path: str, *, windows: bool = os.name == "nt") -> str | None:
    r"""The computer whose share a path names, as ``\\server\share`` and ``//server/share`` do.

    None for any other path. Where the system is not Windows, there are no such names:
    ``//server/share`` is a folder like any other.
    """
    text = path.replace("/", "\\")
    if not windows:
        return None
    if text.startswith(_DEVICES):
        text = text[4:]
        if text[1:2] == ":":
            return None  # a drive by its long name
        text = "\\\\" + (text[4:] if text[:4].upper() == "UNC\\" else text)
    if not text.startswith("\\\\"):
        return None
    return text.lstrip("\\").partition("\\")[0].casefold() or None


def named_shares(
    network: Network, library: Library, *, windows: bool = os.name == "nt"
) -> dict[tuple[str, str], str]:
    """The computers that file names in a network lead to, by node and parameter."""
    servers: dict[tuple[str, str], str] = {}
    if not windows:
        return servers
    for node in network.nodes.values():
        if node.module not in library:
            continue
        for parameter in declaration(library[node.module]).parameters:
            value = node.params.get(parameter.name)
            if parameter.kind == "path" and isinstance(value, str):
                server = share_server(value, windows=windows)
                if server is not None:
                    servers[node.id, parameter.name] = server
    return servers


def check_shares(
    network: Network,
    library: Library,
    *,
    given: Collection[tuple[str, str]] = (),
    places: Collection[Path] = (),
    windows: bool = os.name == "nt",
) -> None:
    """Refuse files on computers that the command line does not name.

    Parameters
    ----------
    network, library
        What is to run.
    given : collection of (str, str)
        Nodes and parameters whose values are the command line's.
    places : collection of Path
        Other files and folders of the command line.
    windows : bool
        Whether paths are those of Windows.

    Raises
    ------
    NetworkError
        Naming node, file and computer.
    """
    servers = named_shares(network, library, windows=windows)
    trusted = {servers[key] for key in given if key in servers}
    trusted |= {server for place in places if (server := share_server(str(place), windows=windows))}
    for (node, name), server in servers.items():
        if server not in trusted:
            value = shown(str(network.nodes[node].params[name]))
            raise NetworkError(
                f"{name} = {value} lies on another computer, {shown(server)}, that the command "
                f"line does not name: --set {node}.{name}=… with that path allows it",
                node=node,
            )
