"""The editor's tests draw offscreen, unless they start a display of their own.

Offscreen, Qt has a screen of 800×800, to which it cuts a window that is remembered; the tests have
one of 1920×1080.
"""

import gc
import os
from pathlib import Path

import pytest

os.environ.setdefault(
    "QT_QPA_PLATFORM",
    f"offscreen:configfile={Path(__file__).parents[2] / 'support' / 'screen.json'}",
)

from PySide6.QtCore import QCoreApplication, QEvent

from app.editor.canvas.canvas import Canvas
from app.editor.evaluation.evaluator import Evaluator
from app.editor.session import Level, Session
from app.editor.theme import DARK
from app.editor.window.main_window import MainWindow
from app.editor.window.recent_files import Settings
from app.run.shipped import shipped_networks
from canvas_hands import CanvasHands
from core.editing.document import Document
from core.network.file import load_network
from nodes.library import standard_library
from panel_hands import NoEvaluator
from patient_bot import PatientBot

HERE = Path(__file__).parent


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item, nextitem):
    """Collect garbage after a test, in its thread: it holds widgets of windows that were closed.

    By itself Python collects wherever it allocates, in a thread that evaluates as well, and there a
    widget must not be deleted. As often as Python would, that is: all of it is looked through
    where the younger objects were collected ten times.
    """
    # Called for tests of other folders, too, which are thousands: to look through all objects after
    # each took longer than the tests.
    if not item.path.is_relative_to(HERE):
        return (yield)
    gc.disable()
    try:
        return (yield)
    finally:
        ends = nextitem is None or not nextitem.path.is_relative_to(HERE)
        young, _, old = gc.get_threshold()
        if ends or gc.get_count()[2] > old:
            gc.collect()
        elif gc.get_count()[0] > young:
            gc.collect(1)
        if ends:
            gc.enable()


@pytest.fixture(autouse=True)
def _what_was_closed_is_deleted():
    """Qt deletes what was to be deleted only in a loop of its own, which the tests have not."""
    yield
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


@pytest.fixture
def qtbot(qapp, request):
    qapp.setPalette(DARK.palette())
    return PatientBot(request)


@pytest.fixture
def library():
    return standard_library()


@pytest.fixture
def session(qtbot, library):
    """A session with an empty document."""
    made = Session(library)
    made.open(Document(made.network, library=library))
    yield made
    made.deleteLater()


@pytest.fixture
def opened(session, library):
    """Open a shipped network by name in the session."""

    def open_network(name):
        path = shipped_networks()[name]
        session.open(Document(load_network(path, library=library), library=library, path=path))
        return session

    return open_network


@pytest.fixture
def evaluator(session):
    """A worker behind the session."""
    made = Evaluator(session)
    yield made
    made.close()
    made.deleteLater()


@pytest.fixture
def canvas(qtbot, session):
    """A canvas on the session, shown and with the focus."""
    made = Canvas(Level(session, session), NoEvaluator(session))
    qtbot.addWidget(made)
    made.resize(1000, 600)
    made.show()
    qtbot.waitExposed(made)
    made.activateWindow()
    made.setFocus()
    return made


@pytest.fixture
def hand(canvas):
    """A hand on the mouse and the keys, above the canvas."""
    return CanvasHands(canvas)


@pytest.fixture
def settings(tmp_path):
    """Settings of this test alone."""
    return Settings(tmp_path / "config" / "editor.ini")


@pytest.fixture
def make_window(qtbot, library, settings, tmp_path):
    """Windows that end with the test."""
    made = []

    def make(**choices):
        chosen = {"library": library, "settings": settings, "recovery": tmp_path / "recovery"}
        window = MainWindow(**{**chosen, **choices})
        made.append(window)
        if not chosen["settings"].path.exists():  # else it has the size that is remembered
            window.resize(1600, 900)
        window.show()
        qtbot.waitExposed(window)
        assert window.shelf.presets  # they would come to the library while the test looks at it
        return window

    yield make
    for window in made:
        window.close_for_good()
        window.deleteLater()


@pytest.fixture
def window(make_window):
    """A window with its welcome page."""
    return make_window()


@pytest.fixture
def idle(qtbot):
    """Wait until a window has computed all it wants."""

    def wait(window):
        qtbot.wait(60)
        qtbot.waitUntil(lambda: window.evaluator.idle)
        qtbot.wait(60)

    return wait
