"""``imagechain check``: every fault of a network, without computing anything."""

from __future__ import annotations

from app.arguments import Options
from app.evaluation import planned
from app.run import open_network
from app.shipped import find_network
from core.engine import Engine
from core.errors import InputError
from core.validate import NetworkProblems
from nodes.library import standard_library


def check(options: Options) -> None:
    """Print each error, or that there is none.

    Raises
    ------
    InputError
        Again, once all are printed.
    """
    library = standard_library()
    try:
        place = find_network(options.network)
        network = open_network(place, options, library)
        planned(Engine(library), network, place.folder)
    except NetworkProblems as found:
        for problem in found.problems:
            print(problem)
        raise
    except InputError as error:
        print(error)
        raise
    print(f"{place.name}: no errors ({len(network.nodes)} nodes, {len(network.links)} links)")
