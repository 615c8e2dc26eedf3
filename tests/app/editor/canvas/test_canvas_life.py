"""Nothing is left of items that have gone; a hundred nodes are drawn and dragged."""

import gc
import weakref
from dataclasses import replace
from types import SimpleNamespace

import pytest
from PySide6.QtCore import QEvent, QPoint
from PySide6.QtWidgets import QApplication

from app.editor.canvas.canvas import Canvas
from app.editor.canvas.canvas_style import CanvasStyle
from app.editor.canvas.node_item import NodeItem
from app.editor.evaluation.queries import Badge
from app.editor.session import Session
from app.run.shipped import shipped_networks
from canvas_networks import long_chain
from core.editing.document import Document
from core.editing.operations import Remove
from core.network.file import load_network


def collect():
    QApplication.processEvents()
    gc.collect()


def test_removed_items_are_gone(opened, canvas, hand):
    session = opened("kodak_kir310")
    canvas.set_badges({"optics": Badge("error", "no")})
    hand.drag(hand.head("optics"), hand.head("optics") + QPoint(9, 40))
    hand.click(hand.port("optics", "magnitude", "output"))
    content = canvas.content
    items = [content.nodes["optics"], *content.nodes["optics"].ports.values()]
    items += content.wires_at("optics")
    gone = [weakref.ref(item) for item in items]
    del items
    session.do(Remove(("optics",)))
    collect()
    assert [ref() for ref in gone if ref() is not None] == []


def test_fifty_networks_leave_no_more_items_than_one(session, canvas, library):
    networks = [load_network(path, library=library) for path in shipped_networks().values()]
    made = []
    for number in range(50):
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
    assert len(made) > 1000
    assert len(alive) == len(last.nodes) + len(last.links) + ports
    shown = [item for item in canvas.view.scene().items() if isinstance(item, NodeItem)]
    assert len(shown) == len(last.nodes)


def test_a_closed_canvas_is_gone_though_its_session_lives(session, library):
    gone = []
    for _ in range(3):
        canvas = Canvas(session)
        canvas.show()
        session.open(Document(long_chain(12), library=library))
        canvas.open_search()
        canvas.close()
        gone += [weakref.ref(canvas), weakref.ref(canvas.view), weakref.ref(canvas.content)]
        canvas.deleteLater()
        del canvas
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        collect()
    assert [ref() for ref in gone if ref() is not None] == []
    session.open(Document(long_chain(5), library=library))


def test_a_session_can_go_before_its_canvas(qtbot, library):
    session = Session(library)
    canvas = Canvas(session)
    qtbot.addWidget(canvas)
    canvas.show()
    session.open(Document(long_chain(8), library=library))
    canvas.grab()


def test_a_hundred_nodes_are_drawn_and_dragged(session, canvas, hand, library):
    session.open(Document(long_chain(), library=library))
    assert len(canvas.content.nodes) == 100
    assert len(canvas.content.wires) == 197
    canvas.frame_all()
    items = dict(canvas.content.nodes)
    start = hand.head("jitter_40")
    hand.drag(start, start + QPoint(25, 18))
    assert session.document.history.position == 1
    assert session.network.layout["jitter_40"] != long_chain().layout["jitter_40"]
    assert canvas.content.nodes == items


def counted_metrics(metrics, counted):
    """What measures texts, and counts how often."""

    def advance(text):
        counted.append(text)
        return metrics.horizontalAdvance(text)

    return SimpleNamespace(height=metrics.height, horizontalAdvance=advance)


@pytest.mark.parametrize("zoom", [0.5, 0.2])
def test_titles_are_measured_once_for_a_zoom(session, canvas, library, monkeypatch, zoom):
    measured, metrics = [], CanvasStyle.metrics
    monkeypatch.setattr(
        CanvasStyle, "metrics", lambda style, size: counted_metrics(metrics(style, size), measured)
    )
    session.open(Document(long_chain(), library=library))
    canvas.frame_all()
    canvas.zoom_by(zoom * canvas.view.style_of_canvas.natural_zoom / canvas.view.zoom)
    canvas.view.grab()
    assert len(measured) <= 30 * 100
    assert measured or zoom == 0.2  # there none is drawn
    measured.clear()
    canvas.view.grab()
    assert not measured


def test_a_row_of_nodes_is_framed_whole_however_long(session, canvas, library):
    row = replace(long_chain(400), layout={})
    row = replace(row, layout={name: (240.0 * n, 0.0) for n, name in enumerate(row.nodes)})
    session.open(Document(row, library=library))
    canvas.frame_all()
    assert canvas.view.visible_rect().contains(canvas.content.bounds())
    zoom = canvas.view.zoom
    canvas.zoom_by(0.5)
    assert canvas.view.zoom == zoom
    canvas.zoom_by(1.5)
    assert canvas.view.zoom > zoom
