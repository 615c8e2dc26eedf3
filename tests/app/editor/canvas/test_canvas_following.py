"""The canvas shows what the document holds, and follows each change of it."""

import pytest

from app.editor.canvas.node_item import NodeItem
from app.editor.canvas.wires import WireItem
from core.editing.document import Document
from core.editing.operations import add_nodes, move_nodes, remove_nodes, rename_node, rewire
from core.network.network import Link, Network, Node

pytestmark = pytest.mark.usefixtures("qtbot")


def shown(canvas):
    """What the items show, as a document would say it."""
    content = canvas.content
    nodes = {name: item.face.module for name, item in content.nodes.items()}
    places = {name: (item.x(), item.y()) for name, item in content.nodes.items()}
    return nodes, set(content.wires), places


def drawn_items(canvas):
    """Nodes and wires in the scene, whatever the canvas's lists say."""
    items = canvas.view.scene().items()
    return tuple(sum(isinstance(item, kind) for item in items) for kind in (NodeItem, WireItem))


def test_ports_are_the_modules_from_top_to_bottom(opened, canvas):
    opened("kodak_kir310")
    ports = canvas.content.nodes["electronics"].ports
    inputs = [name for side, name in ports if side == "input"]
    outputs = [name for side, name in ports if side == "output"]
    assert inputs == ["image", "context"]
    assert outputs[:2] == ["image", "noise"]
    heights = [ports["output", name].pos().y() for name in outputs]
    assert heights == sorted(heights)
    assert len(set(heights)) == 7


def test_edits_undo_and_redo_are_followed(opened, canvas):
    session = opened("first_steps")
    before = shown(canvas)
    session.do(add_nodes(((Node("jitter", "jitter_mtf"), (100.0, 300.0)),)))
    session.do(rewire(add=(Link.between("init.magnitude", "jitter.magnitude"),)))
    session.do(move_nodes({"scene": (-50.0, 20.0)}))
    for wire in canvas.content.wires.values():
        path = wire.path()
        assert path.pointAtPercent(0) == wire.output_port.scenePos()
        assert path.pointAtPercent(1) == wire.input_port.scenePos()
    session.do(rename_node("blur", "haze"))
    session.do(remove_nodes(("back",)))
    after = shown(canvas)
    assert after[0].keys() == {"scene", "init", "haze", "picture", "jitter"}
    assert after[2]["scene"] == (-50.0, 20.0)
    assert drawn_items(canvas) == (5, 4)
    for _ in range(5):
        session.undo()
    assert shown(canvas) == before
    assert drawn_items(canvas) == (5, 6)
    for _ in range(5):
        session.redo()
    assert shown(canvas) == after


def test_an_unknown_module_shows_its_key_and_the_ports_of_its_links(session, canvas, library):
    links = (Link.between("scene.image", "odd.picture"), Link.between("odd.result", "show.image"))
    network = Network(
        nodes={
            "scene": Node("scene", "test_scene"),
            "odd": Node("odd", "module_of_tomorrow"),
            "show": Node("show", "examine_image"),
        },
        links=links,
        layout={"scene": (0, 0), "odd": (240, 0), "show": (480, 0)},
    )
    session.open(Document(network, library=library))
    face = canvas.content.nodes["odd"].face
    assert not face.known
    assert face.module == "module_of_tomorrow"
    assert [port.name for port in face.inputs] == ["picture"]
    assert [port.name for port in face.outputs] == ["result"]
    assert set(canvas.content.wires) == set(links)
    session.do(rewire(add=(Link.between("odd.other", "show.image"),)))
    face = canvas.content.nodes["odd"].face
    assert [port.name for port in face.outputs] == ["other"]
    assert Link.between("odd.other", "show.image") in canvas.content.wires


def test_nodes_without_a_point_stand_beside_each_other(session, canvas, library):
    keys = {"scene": "test_scene", "init": "init_trans", "second": "test_scene"}
    nodes = {name: Node(name, key) for name, key in keys.items()}
    network = Network(nodes=nodes, links=(Link.between("scene.image", "init.image"),))
    session.open(Document(network, library=library))
    frames = [item.frame() for item in canvas.content.nodes.values()]
    assert not any(one.intersects(other) for one in frames for other in frames if one is not other)
    assert canvas.content.nodes["init"].x() > canvas.content.nodes["scene"].x()
    assert not session.document.modified
