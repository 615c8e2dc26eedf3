"""Which other computers the person lets this session read from."""

from __future__ import annotations

import os
from pathlib import Path

from app.permission.shares import named_shares, share_server
from core.errors import FileError
from core.modules.library_type import Library
from core.network.network import Network


class Shares:
    """Answers to the question whether to read from a computer; forgotten with the session.

    Parameters
    ----------
    windows : bool
        Whether paths are those of Windows; elsewhere there are no shares.
    """

    def __init__(self, *, windows: bool = os.name == "nt") -> None:
        self._windows = windows
        self._answers: dict[str, bool] = {}

    def answer(self, server: str, allowed: bool) -> None:
        """Remember an answer."""
        self._answers[server] = allowed

    def allow(self, path: Path) -> None:
        """Allow the computer of a path that the person has opened."""
        server = share_server(str(path), windows=self._windows)
        if server is not None:
            self.answer(server, True)

    def bars(self, path: Path) -> bool:
        """Whether a path lies on a computer that is not allowed."""
        server = share_server(str(path), windows=self._windows)
        return server is not None and not self._answers.get(server, False)

    def unanswered(self, network: Network, library: Library) -> tuple[str, ...]:
        """Computers that a network names and the person has not been asked about."""
        servers = named_shares(network, library, windows=self._windows).values()
        return tuple(server for server in dict.fromkeys(servers) if server not in self._answers)

    def without_barred(
        self, network: Network, library: Library
    ) -> tuple[Network, dict[str, FileError]]:
        """A network that names no file on a computer not allowed; and by node why not."""
        barred: dict[str, FileError] = {}
        for (node, name), server in named_shares(network, library, windows=self._windows).items():
            if not self._answers.get(server, False):
                why = f"the file lies on another computer, {server}: not read unless you allow it"
                barred[node] = FileError(why, node=node)
                network = network.with_parameter(node, name, None)
        return network, barred
