"""``imagechain networks``: the networks that come with the program."""

from __future__ import annotations

import json
import textwrap
from pathlib import Path

from app.run.shipped import shipped_networks

_WIDTH = 96


def network_list() -> None:
    """Print the name by which each can be run, its title and what it shows."""
    print("\n".join(_entry(name, path) for name, path in shipped_networks().items()))


def _entry(name: str, path: Path) -> str:
    document = json.loads(path.read_text(encoding="utf-8"))
    shows = textwrap.fill(
        document["description"], _WIDTH, initial_indent="  ", subsequent_indent="  "
    )
    return f"{name} · {document['name']}\n{shows}"
