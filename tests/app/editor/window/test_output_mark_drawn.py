"""The mark of the output in the window: key, menu, panel, canvas, figures and legend."""

import pytest

from app.editor.viewers.plot.figures_strip import FiguresStrip
from app.editor.viewers.plot.plot_viewer import PlotViewer
from app.run.shipped import shipped_networks
from core.editing.document import Document
from core.editing.operations import add_nodes, mark_output
from core.network.file import load_network
from core.network.network import Link, Node
from viewer_bench import ViewerBench
from window_hands import KEY

SECOND = add_nodes(
    (
        (Node("other", "test_scene", {"width": 16, "height": 16}), (0.0, 900.0)),
        (Node("noisy", "poisson_noise"), (240.0, 900.0)),
    ),
    (Link("other", "image", "noisy", "image"),),
)


def marked(session):
    return [name for name, node in session.network.nodes.items() if node.final]


def test_the_key_marks_unmarks_and_refuses_in_words(window, hand, library):
    path = shipped_networks()["first_steps"]
    window.session.open(Document(load_network(path, library=library), library=library, path=path))
    hand.focus()
    session, told = window.session, []
    session.message.connect(lambda *words: told.append(words))
    hand.select("back")
    hand.key(KEY.Key_O)
    assert marked(session) == ["back"]
    assert window.canvas.content.nodes["back"].face.output
    assert "output" in window.canvas.content.nodes["back"].toolTip()
    hand.key(KEY.Key_O)
    assert marked(session) == []
    assert not window.canvas.content.nodes["back"].face.output
    session.undo()
    assert marked(session) == ["back"]
    del told[:]
    hand.select("init")
    hand.key(KEY.Key_O)
    assert marked(session) == ["back"]
    assert told == [("error", "init cannot be the output: it has no picture")]


def test_the_mark_is_painted(canvas, opened):
    session = opened("inframetrics")
    session.do(mark_output(()))
    item = canvas.content.nodes["frame_grabber"]
    canvas.frame_all()

    def colours():
        shot = canvas.grab().toImage()
        return {shot.pixel(x, y) for x in range(shot.width()) for y in range(0, shot.height(), 2)}

    before = colours()
    session.do(mark_output(("frame_grabber",)))
    assert item.face.output
    assert colours() != before


@pytest.fixture
def bench(qtbot, opened):
    made = ViewerBench(qtbot, opened("measured_mtf"))
    yield made
    made.close()


def test_strip_and_legend_name_the_output_or_say_how_to_mark_it(bench):
    strip = bench.show(FiguresStrip(bench.session, bench.evaluator), 1000, 40)
    viewer = bench.show(PlotViewer(bench.session, bench.evaluator))

    def texts():
        return [viewer.list.item(row).text() for row in range(viewer.list.count())]

    assert strip.text("output") == "electronics.image"
    assert "Total" in texts()
    bench.do(SECOND)
    assert strip.text("output") == "2 pictures"
    told = strip.label("output").toolTip()
    assert "electronics.image, noisy.image" in told
    assert "press O" in told
    assert strip.text("snr") != "—"  # there is one electronics: no doubt which is meant
    assert "Total" not in texts()
    assert texts()[0].startswith("no Total: this network ends in 2 pictures")
    assert "press O" in viewer.status.title.text()
    bench.do(mark_output(("electronics",)))
    assert "Total" in texts()
    assert not texts()[0].startswith("no Total")
    bench.do(mark_output(("noisy",)))
    assert strip.text("output") == "noisy.image"
    assert texts()[0] == "no Total: no Back Transform comes before the output, noisy.image"
