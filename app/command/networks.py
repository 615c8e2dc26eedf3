"""``imagechain networks``: the networks that come with the program."""

from __future__ import annotations

import json
import textwrap

from app.command.results import show
from app.options.command_options import Options
from app.run.shipped import published_networks, shipped_networks


def carry_out(options: Options, _stop: object) -> None:
    facts = [
        {"network": name, "name": document["name"], "description": document["description"]}
        for name, path in shipped_networks().items()
        for document in [json.loads(path.read_text(encoding="utf-8"))]
    ]
    cameras = (
        f"published cameras (imagechain handbook published): {', '.join(published_networks())}"
    )
    show(options, lambda: facts, *map(_entry, facts), textwrap.fill(cameras, 96))


def _entry(fact: dict[str, str]) -> str:
    shows = textwrap.fill(fact["description"], 96, initial_indent="  ", subsequent_indent="  ")
    return f"{fact['network']} · {fact['name']}\n{shows}"
