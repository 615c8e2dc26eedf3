"""A window to be measured: as a person's, but with settings of its own."""

import contextlib
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from PySide6.QtCore import QCoreApplication, QEvent, QEventLoop, QObject
from PySide6.QtWidgets import QApplication, QGraphicsView

from app.editor.evaluation.queries import Answer
from app.editor.qt_libraries import nothing_collected
from app.editor.viewers.picture.image_viewer import ImageViewer
from app.editor.window.main_window import MainWindow
from app.editor.window.recent_files import Settings
from app.editor.window.start import application, settle
from nodes.library import standard_library

SIZE = 1600, 900


@contextlib.contextmanager
def trial_window(network: str = "") -> Iterator[tuple[QApplication, MainWindow]]:
    """An application and its shown window, with a network if one is given; closed at the end."""
    app = application()
    with tempfile.TemporaryDirectory() as folder:
        settings = Settings(Path(folder) / "settings.ini")
        with nothing_collected():
            window = MainWindow(
                library=standard_library(),
                settings=settings,
                recovery=Path(folder),
                remembered=False,
            )
            window.resize(*SIZE)
            if network:
                window.open_first(network)
            window.show()
        try:
            yield app, window
        finally:
            window.close_for_good()
            app.processEvents()


def live(seconds: float) -> None:
    """Run the event loop for a while; without a loop of its own, Qt deletes nothing by itself."""
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, int(1000 * left) + 1)
        time.sleep(0.0005)
    QCoreApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


class PaintedPictures(QObject):
    """Counts the pictures of a viewer that have come to be painted, and notes when.

    Two pictures between one painting and the next count as one: the first was never seen.
    """

    def __init__(self, window: MainWindow, viewer: ImageViewer) -> None:
        super().__init__(viewer)
        self.times: list[float] = []
        self.reduced = 0
        self._viewer = viewer
        self._fresh: Answer | None = None
        window.evaluator.answered.connect(self._answered)
        for view in viewer.findChildren(QGraphicsView):
            view.viewport().installEventFilter(self)

    def eventFilter(self, _watched: QObject, event: QEvent) -> bool:  # noqa: N802
        """Look for paintings after an answer."""
        if event.type() == QEvent.Type.Paint and self._fresh is not None:
            self.times.append(time.monotonic())
            self.reduced += self._fresh.reduced > 1
            self._fresh = None
        return False

    def _answered(self, answer: Any) -> None:
        if answer.owner == self._viewer.owner and answer.value is not None:
            self._fresh = answer


__all__ = ["PaintedPictures", "live", "settle", "trial_window"]
