"""Damaged network files: refused in one line that says what or where, or kept as they are."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

from cases import Case
from commands import ended
from library_networks import Document
from library_networks import Network as Drawing
from mutations import mutated

from app.editor.window.files import open_network_file
from app.run.shipped import shipped_networks
from core.errors import ImagechainError
from core.network.file import format_network, load_network, read_network, save_network
from core.network.network import Network
from nodes.library import standard_library

NAME, AGAIN = "net.json", "again.json"


def try_damaged_file(case: Case) -> None:
    """Damage a shipped network or a drawn one; check it, open it, save it, open it again."""
    random = case.random
    is_drawn = random.random() < 0.5
    shipped = random.choice(_shipped())
    document = Drawing(random, case.folder).document() if is_drawn else shipped
    Path(NAME).write_bytes(mutated(random, document))
    checked = ended(case, ["check", NAME])
    try:
        network = read_network(NAME, library=standard_library())
    except ImagechainError as error:
        case.expect(checked.code == 2, f"check accepts what cannot be read: {error}")
        case.expect(NAME in str(error), f"does not name the file: {error}")
        case.counts["damaged: no network"] += 1
        return
    _expect_round_trip(case, network)
    _expect_opens(case)
    case.counts["damaged: refused later" if checked.code else "damaged: accepted"] += 1
    if checked.code == 0:
        loaded = load_network(NAME, library=standard_library())
        save_network(loaded, AGAIN, library=standard_library())
        case.expect(ended(case, ["check", AGAIN]).code == 0, "saved, but no longer valid")
        if is_drawn and _is_small(network):
            ended(case, ["run", NAME, "--output-dir", "out"])
    else:
        _expect_named(case, network, checked.err)


def _expect_round_trip(case: Case, network: Network) -> None:
    library = standard_library()
    try:
        save_network(network, AGAIN, library=library)
    except ImagechainError as error:
        case.expect(False, f"read, but cannot be saved: {error}")
    again = read_network(AGAIN, library=library)
    case.expect(again == network, "saved and read, it holds something else")
    text = format_network(network, library=library)
    case.expect(format_network(again, library=library) == text, "saved and read, it differs")
    save_network(again, AGAIN, library=library)
    case.expect(Path(AGAIN).read_text() == text, "saved twice, the file differs")


def _expect_opens(case: Case) -> None:
    """The editor opens it or says why not."""
    try:
        opened = open_network_file(Path(NAME), library=standard_library())
    except ImagechainError as error:
        case.expect(bool(str(error)) and "\n" not in str(error), f"not one line: {error}")
        case.counts["editor: refused"] += 1
        return
    opened.document.save(Path(AGAIN))
    again = open_network_file(Path(AGAIN), library=standard_library())
    same = again.document.text() == opened.document.text()
    case.expect(same, "opened in the editor and saved, it differs")
    case.counts["editor: opened"] += 1


def _expect_named(case: Case, network: Network, line: str) -> None:
    """The line says where: a node, a link, a field or the file."""
    places = [*network.nodes, *(node.module for node in network.nodes.values()), "link", NAME]
    shown = [repr(place)[1:40] for place in places] + [place[:40] for place in places]
    fields = ["final", "seed", "the network"]
    case.expect(any(place in line for place in (*shown, *fields)), f"names no place: {line!r}")


def _is_small(network: Network) -> bool:
    """Whether no number in it makes a picture or a loop large."""
    numbers = [
        number
        for node in network.nodes.values()
        for value in node.params.values()
        for number in (value if isinstance(value, tuple) else (value,))
        if isinstance(number, int) and not isinstance(number, bool)
    ]
    return all(abs(number) <= 100 for number in numbers) and not any(
        # Left out, a size has its default.
        node.module in ("test_scene", "exit_pupil") and not {"width", "size_x"} & node.params.keys()
        for node in network.nodes.values()
    )


@cache
def _shipped() -> list[Document]:
    return [json.loads(path.read_text()) for path in shipped_networks().values()]
