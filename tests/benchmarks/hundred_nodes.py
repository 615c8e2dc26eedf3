"""A network of a hundred nodes: how long until it is drawn, and each step of a node's drag."""

import json
import time
from statistics import median

from PySide6.QtWidgets import QApplication

from core.editing.document import Document
from core.editing.operations import move_nodes
from core.network.network import Link, Network, Node
from trial_window import live, settle, trial_window

NODES = 100
COLUMNS = 10
MOVES = 60


def large_network() -> Network:
    """A scene, its transform, and blurs one after the other, each wired to the context."""
    nodes = [Node("scene", "test_scene", {"width": 64, "height": 64}), Node("init", "init_trans")]
    links = [Link("scene", "image", "init", "image")]
    before = "init"
    for number in range(NODES - len(nodes)):
        name = f"jitter_{number}"
        nodes.append(Node(name, "jitter_mtf", {"sigma_mrad": 0.001 * (number + 1)}))
        links.append(Link("init", "context", name, "context"))
        links.append(Link(before, "magnitude", name, "magnitude"))
        before = name
    layout = {
        node.id: (260.0 * (n % COLUMNS), 180.0 * (n // COLUMNS)) for n, node in enumerate(nodes)
    }
    return Network("hundred", nodes={n.id: n for n in nodes}, links=tuple(links), layout=layout)


def main() -> None:
    """Load it, drag a node, print the times."""
    with trial_window() as (_, window):
        library = window.session.library
        settle(window)
        document = Document(large_network(), library=library)
        start = time.perf_counter()
        window.files.show(document)
        QApplication.processEvents()
        loaded = time.perf_counter() - start
        settle(window)
        steps = []
        for number in range(MOVES):
            start = time.perf_counter()
            window.session.do(
                move_nodes({"jitter_40": (500.0 + 7 * number, 700.0)}), gesture="drag"
            )
            QApplication.processEvents()
            steps.append(1e3 * (time.perf_counter() - start))
            live(0.005)
        figures = {"load_s": loaded, "move_ms": median(steps), "slowest_move_ms": max(steps)}
        print(json.dumps(figures))


if __name__ == "__main__":
    main()
