"""Small networks for previews, and their questions answered."""

from PySide6.QtCore import QEvent, QObject
from PySide6.QtWidgets import QApplication

from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Passing
from app.editor.panels.preview_view import PreviewQuery, PreviewView
from app.editor.theme import DARK
from core.chain.engine import Engine
from core.editing.document import Document
from core.evaluation.work import Policy
from linked_network import linked_network
from nodes.library import standard_library

LIBRARY = standard_library()
INFRAMETRICS = {
    "detector_x_um": 600.0,
    "detector_y_um": 600.0,
    "focal_length_mm": 130.0,
    "f_number": 1.75,
    "fill_x": 0.95,
    "fill_y": 0.95,
}


def sensor(key, params=None, *, scene=None, init=None, pupil=None, node="node"):
    """A scene of 30° and 512 samples, Init & Trans, an exit pupil, and one node behind them."""
    nodes = {
        "scene": ("test_scene", {"width": 512, "height": 512, **(scene or {})}),
        "init": ("init_trans", init or {}),
        "pupil": ("exit_pupil", pupil or {}),
        node: (key, params or {}),
    }
    return linked_network(nodes, seed=1)


def engine():
    """A new one."""
    return Engine(LIBRARY)


def passing(network, folder=None):
    """One pass over a network."""
    made = engine()
    work = made.work(Policy("double", threads=1))
    return Passing(made, made.plan(network, folder=folder), work)


def previewed(network, node="node", folder=None):
    """The preview that a node's module makes."""
    return PreviewQuery(node).answer(passing(network, folder))


class PreviewBench:
    """Opens networks in a session and shows previews, with a worker behind them.

    Parameters
    ----------
    qtbot : QtBot
        Waits.
    session : Session
        The document.
    folder : Path
        Where the networks' files are.
    """

    def __init__(self, qtbot, session, folder):
        self._qtbot, self._session, self._folder = qtbot, session, folder
        self.evaluator = None

    def show(self, network, node="node"):
        """The preview of a node."""
        session = self._session
        path = self._folder / "network.json"
        session.open(Document(network, library=session.library, path=path))
        self.evaluator = Evaluator(session)
        widget = PreviewView(session, self.evaluator, node)
        widget.setPalette(DARK.palette())
        self._qtbot.addWidget(widget)
        widget.resize(340, widget.sizeHint().height())
        widget.show()
        self.settle()
        return widget

    def settle(self):
        """Until all that is wanted has been answered."""
        self._qtbot.waitUntil(lambda: self.evaluator.idle)
        QApplication.processEvents()

    def close(self):
        """Stop the worker."""
        if self.evaluator is not None:
            self.evaluator.close()


class Paints(QObject):
    """Counts how often a widget is painted."""

    def __init__(self, widget):
        super().__init__(widget)
        self.count = 0
        widget.installEventFilter(self)

    def eventFilter(self, _watched, event):  # noqa: N802
        self.count += event.type() == QEvent.Type.Paint
        return False


def told(widget):
    """What it shows, in words; painted first."""
    widget.grab()
    return widget.accessibleDescription()
