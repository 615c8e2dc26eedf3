"""Viewers with a real worker behind them, for the tests of the editor."""

import gc
import weakref

from PySide6.QtCore import QCoreApplication, QEvent

from app.editor.evaluation.evaluator import Evaluator
from core.chain.engine import Engine
from core.evaluation.work import Policy


class ViewerBench:
    """Shows viewers on a session, and waits for what they show.

    Parameters
    ----------
    qtbot : QtBot
        Waits.
    session : Session
        The document.
    """

    def __init__(self, qtbot, session):
        self._qtbot = qtbot
        self.session = session
        self.evaluator = Evaluator(session)
        self.answers = []
        self.evaluator.answered.connect(self._note)
        self._viewers = []

    def show(self, viewer, width=640, height=360):
        self._qtbot.addWidget(viewer)
        self._viewers.append(viewer)
        viewer.resize(width, height)
        viewer.show()
        self.settle()
        return viewer

    def settle(self):
        """Until all that is wanted has been answered."""
        self._qtbot.waitUntil(lambda: self.evaluator.idle)
        QCoreApplication.processEvents()

    def do(self, operation):
        assert self.session.do(operation)
        self.settle()

    def truth(self):
        """An engine, plan and work of their own on the document as it stands."""
        engine = Engine(self.session.library)
        plan = engine.plan(self.session.network, folder=self.session.folder)
        return engine, plan, engine.work(Policy())

    def value(self, port):
        engine, plan, work = self.truth()
        return engine.value(plan, port, work)

    def close(self):
        for viewer in self._viewers:
            viewer.close()
        self.evaluator.close()

    def _note(self, answer):
        self.answers.append(answer)


def is_freed(make):
    """Whether nothing holds the viewer that `make` gives once Qt has deleted it."""
    viewer = make()
    held = [weakref.ref(viewer), weakref.ref(getattr(viewer, "canvas", viewer))]
    viewer.close()
    viewer.deleteLater()
    del viewer
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete)
    gc.collect()
    return all(each() is None for each in held)
