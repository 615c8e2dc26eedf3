"""Nothing is left of items that have gone; a hundred nodes are drawn and dragged."""

import gc
import weakref

from PySide6.QtWidgets import QApplication

from app.editor.canvas.node_item import NodeItem
from app.editor.evaluation.queries import Badge
from app.run.shipped import shipped_networks
from core.editing.document import Document
from core.network.file import load_network


def collect():
    QApplication.processEvents()
    gc.collect()


def test_twenty_networks_leave_no_more_items_than_one(session, canvas, library):
    networks = [load_network(path, library=library) for path in shipped_networks().values()]
    made = []
    for number in range(20):
        network = networks[number % len(networks)]
        session.open(Document(network, library=library))
        canvas.set_badges(dict.fromkeys(network.nodes, Badge("stale", "waits")))
        canvas.view.grab()
        content = canvas.content
        for item in (*content.nodes.values(), *content.wires.values()):
            made.append(weakref.ref(item))
            made += [weakref.ref(port) for port in getattr(item, "ports", {}).values()]
    del item, content
    collect()
    last = session.network
    ports = sum(len(item.ports) for item in canvas.content.nodes.values())
    alive = [ref() for ref in made if ref() is not None]
    assert len(made) > 500
    assert len(alive) == len(last.nodes) + len(last.links) + ports
    shown = [item for item in canvas.view.scene().items() if isinstance(item, NodeItem)]
    assert len(shown) == len(last.nodes)
