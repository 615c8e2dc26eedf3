"""The measuring dock: edges are clicked, removed, used again; results written, work stopped."""

import json
import math
import re
import threading
import time

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from scipy.ndimage import gaussian_filter
from scipy.special import erf

from app.editor.docks.edges import EdgeCanvas, edge_look
from app.editor.docks.measure_view import MeasureView, check_stop
from app.editor.theme import THEMES
from app.measure.measurement_text import REMOVED, USED
from child_process import PATIENCE_S
from core.editing.operations import set_network_field
from window_hands import choose_file, show_small

SIGMA = 0.8


@pytest.fixture(scope="module")
def two_edges(tmp_path_factory):
    """Two edges beside one another."""
    y, x = np.mgrid[0:160, 0:240]
    picture = np.full(x.shape, 50.0)
    for middle, sign in ((60.2, 1.0), (180.4, -1.0)):
        away = (x - middle) * math.cos(0.1) + (y - 80) * math.sin(0.1)
        picture += sign * 20.0 * (1.0 + erf(away / (math.sqrt(2.0) * SIGMA)))
    picture += np.random.default_rng(2).normal(0.0, 0.3, x.shape)
    path = tmp_path_factory.mktemp("pictures") / "two.npy"
    np.save(path, picture)
    return path


@pytest.fixture
def view(qtbot, session):
    made = MeasureView(session, {})
    qtbot.addWidget(made)
    made.resize(1000, 420)
    made.show()
    qtbot.waitExposed(made)
    yield made
    made.end_work()


@pytest.fixture
def measured(view, qtbot, two_edges):
    choose_file(view.file, two_edges)
    assert view.stop.isEnabled()
    assert view.canvas.hint.text() == "Measuring …"
    qtbot.waitUntil(lambda: view.measured is not None)
    return view


def mtf_figures(view):
    """What the table of figures calls those of the MTF."""
    texts = [view.figures.item(row, 0).text() for row in range(view.figures.rowCount())]
    return [text for text in texts if "MTF" in text]


def click(qtbot, view, point):
    qtbot.wait(QApplication.doubleClickInterval() + 50)
    qtbot.mouseClick(view.canvas.viewport(), Qt.MouseButton.LeftButton, pos=point)


def test_an_edge_is_clicked_removed_and_used_again(measured, qtbot):
    view = measured
    used = [place for place, edge in enumerate(view.measured.edges) if edge.used]
    assert len(used) == 2
    both = view.measured.x
    assert both.edges == 2
    assert len(mtf_figures(view)) == 2
    assert all(text.endswith("from 2 edges") for text in mtf_figures(view))
    second = max(used, key=lambda place: view.measured.edges[place].found.x)
    found, canvas = view.measured.edges[second].found, view.canvas
    click(qtbot, view, canvas.mapFromScene(canvas.view.mapViewToScene(QPointF(found.x, found.y))))
    assert view.current == second
    assert f"edge {second + 1}" in view.status.title.text()
    assert view.table.currentItem().text(0) == str(second + 1)
    qtbot.mouseClick(view.remove, Qt.MouseButton.LeftButton)
    assert all(text.endswith("from 1 edge") for text in mtf_figures(view))
    assert view.measured.x.edges == 1
    # A Gaussian has its MTF50 at √(ln 2 / 2) / (π σ).
    truth = math.sqrt(math.log(2.0) / 2.0) / math.pi / SIGMA
    assert view.measured.x.mtf50 == pytest.approx(truth, abs=4.0 * view.measured.x.mtf50_sigma)
    assert edge_look(view.measured.edges[second])[0] == REMOVED
    assert view.remove.text() == "Use Edge Again"
    first = next(place for place in used if place != second)
    view.choose(first)
    qtbot.keyClick(view.canvas, Qt.Key.Key_Delete)
    assert mtf_figures(view) == []
    texts = [text for _, text in view.notices.left]
    assert "No horizontal MTF: you removed 2 edges that would give this MTF." in texts
    qtbot.mouseClick(view.remove, Qt.MouseButton.LeftButton)
    view.choose(second)
    qtbot.keyClick(view.table, Qt.Key.Key_Space)
    assert view.measured.x.mtf50 == both.mtf50
    assert edge_look(view.measured.edges[second])[0] == USED
    qtbot.keyClick(view.canvas, Qt.Key.Key_Right)
    assert view.current == (second + 1) % len(view.measured.edges)
    click(qtbot, view, QPoint(3, 3))
    assert view.current == -1


def test_the_mtf_under_the_mouse_is_told(measured):
    """Of a Gaussian of σ samples it is exp(−2π²σ²f²)."""
    chart = measured.chart
    QTest.mouseMove(chart, QPoint(chart.width() // 3, chart.height() // 2))
    told = re.match(
        r"([\d.]+) cycles/sample: horizontal ([\d.]+) ± ([\d.]+)", measured.status.more.text()
    )
    frequency, mtf, error = map(float, told.groups())
    assert 0.1 < frequency < 0.4
    truth = math.exp(-2.0 * (math.pi * SIGMA * frequency) ** 2)
    assert mtf == pytest.approx(truth, abs=4.0 * error + 0.002)
    QTest.mouseMove(chart, QPoint(1, 1))
    assert measured.status.more.text() == ""


def test_one_edge_that_overshoots_gives_no_figure(view, qtbot, two_edges, tmp_path):
    picture = np.load(two_edges)[:, :120]
    np.save(tmp_path / "one.npy", picture + 2.0 * (picture - gaussian_filter(picture, 1.0)))
    choose_file(view.file, tmp_path / "one.npy")
    qtbot.waitUntil(lambda: view.measured is not None)
    assert mtf_figures(view) == []
    texts = [text for _, text in view.notices.left]
    assert any(
        "overshoots" in text and "no other edge confirms the overshoot" in text for text in texts
    )


def test_results_are_written_and_what_fails_is_said(measured, qtbot, tmp_path, two_edges):
    view = measured
    with qtbot.waitSignal(view._session.message) as said:
        view.export(tmp_path / "m.json")
    assert said.args == ["note", f"wrote {tmp_path / 'm.json'}"]
    facts = json.loads((tmp_path / "m.json").read_text())
    assert facts["mtf"]["x"]["mtf50"] == view.measured.x.mtf50
    view.export(tmp_path / "m.txt")
    qtbot.waitUntil(lambda: "must end in" in view.status.title.text())
    view.take_files((tmp_path / "none.npy",))
    qtbot.waitUntil(lambda: "no such file" in view.status.title.text())
    assert view.measured.x.edges == 2
    assert view.status.title.text().endswith("; still showing two.npy")
    assert view.source == (two_edges,)
    view.choose(0)
    assert view.status.title.text().startswith("two.npy: edge 1,")


def test_work_is_stopped_and_shows_nothing(view, qtbot):
    begun, ended = threading.Event(), threading.Event()

    def job(stop, _report):
        begun.set()
        try:
            end = time.monotonic() + PATIENCE_S
            while time.monotonic() < end:
                check_stop(stop)
        finally:
            ended.set()

    view.start(job)
    assert begun.wait(20)
    qtbot.keyClick(view, Qt.Key.Key_Escape)
    assert ended.wait(20)
    assert view.status.title.text() == "Stopped"
    # What to do then stands clear of both sides.
    hint, letter = view.canvas.hint, view.fontMetrics().averageCharWidth()
    assert hint.text().startswith("Choose Measure Viewer")
    for width in (400, 1000):
        view.resize(width, 420)
        image = hint.grab().toImage()
        ground = image.pixel(0, 0)
        inked = [x for x in range(image.width())
                 if any(image.pixel(x, y) != ground for y in range(image.height()))]  # fmt: skip
        assert min(inked[0], image.width() - 1 - inked[-1]) >= 4 * letter
        assert inked[-1] - inked[0] <= 73 * letter
    assert not view.busy
    assert view.measured is None


def test_at_the_end_the_job_is_waited_for(view):
    ended = threading.Event()

    def job(stop, _report):
        stop.wait(PATIENCE_S)
        time.sleep(0.2)  # what it still had to do
        ended.set()

    view.start(job)
    view.end_work()
    assert ended.is_set()
    assert not view.busy


def test_the_window_measures_what_a_viewer_shows(window, qtbot):
    show_small(window, "first_steps", 256)
    viewer = window.viewers.images[1]
    qtbot.waitUntil(lambda: viewer.picture is not None and viewer.picture.reduced == 1)
    window.actions_by_name["measure"].trigger()
    view = window.measuring
    assert view.isVisible()
    qtbot.waitUntil(lambda: view.measured is not None)
    assert view.measured.files[0].name.startswith("viewer 1: ")
    assert view.measured.rows == viewer.picture.facts.rows
    interval = view.measured.interval_x_mrad
    assert interval == viewer.picture.value.interval_x_mrad
    session, old = window.session, " (measured before the latest edits): "
    assert old not in view.status.title.text()
    session.do(set_network_field("seed", session.network.seed + 1))
    assert old in view.status.title.text()
    view.step(1)
    assert old in view.status.title.text()
    session.undo()
    assert old not in view.status.title.text()
    view.viewer.menu().aboutToShow.emit()
    listed = [action.text() for action in view.viewer.menu().actions()]
    assert any(text.startswith("Viewer &1: ") for text in listed)
    for button in (view.viewer, view.file, view.stop, view.remove, view.unused, view.write):
        assert button.toolTip()
        assert button.accessibleName()
    show_small(window, "pupils")
    assert view.measured is None
    assert view.source is None
    assert view.table.topLevelItemCount() == 0
    assert view.status.title.text() == ""


def test_the_ground_of_a_picture_follows_the_theme(qtbot):
    app = QApplication.instance()
    app.setPalette(THEMES["dark"].palette())
    canvas = EdgeCanvas(None)
    qtbot.addWidget(canvas)
    app.setPalette(THEMES["light"].palette())
    qtbot.waitUntil(lambda: canvas.backgroundBrush().color() == THEMES["light"].surround)
    app.setPalette(THEMES["dark"].palette())
