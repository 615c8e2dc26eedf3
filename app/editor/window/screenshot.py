"""Drawing the window to a file without a display, for documentation and checks."""

from __future__ import annotations

import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import QCoreApplication, QEventLoop, QSize, Qt
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QWidget

from app.editor.theme import THEMES, Look
from app.editor.window.documents.opening import open_named
from app.editor.window.documents.remembered_settings import Settings
from app.editor.window.main_window import MainWindow
from app.tradeoff.tradeoff_figures import SENSORS
from core.atomic import write_bytes
from core.errors import FileError, UsageError
from nodes.library import standard_library

PATIENCE_S = 120.0
_SETTLE_S = 0.4  # queued answers and repaints after the last pass


@dataclass(frozen=True)
class Shot:
    """A picture to be taken: where to, the window's size, its colours, and what part of it."""

    file: Path
    size: tuple[int, int]
    look: Look
    part: str = "window"


def take(app: QApplication, network: str, shot: Shot) -> None:
    """Open a network in a window off screen, wait until all is computed, and draw it.

    Without a network the welcome page is drawn.

    Raises
    ------
    ImagechainError
        If the network cannot be opened, or the file not written.
    """
    library = standard_library()
    opened = open_named(network, library=library) if network else None
    with tempfile.TemporaryDirectory() as folder:
        settings = Settings(Path(folder) / "settings.ini")
        settings.look = shot.look
        window = MainWindow(
            library=library, settings=settings, recovery=Path(folder), remembered=False
        )
        try:
            window.set_theme(THEMES[shot.look])
            window.resize(*shot.size)
            window.show()
            settle(window)
            if opened is not None:
                window.files.show(opened)
                settle(window)
                _select_node_with_figures(window)
                settle(window)
            write_bytes(shot.file, encoded(_image(window, shot)))
        finally:
            window.close_for_good()
            app.processEvents()


def _select_node_with_figures(window: MainWindow) -> None:
    """Select a node where the first look selects none: where the sensor's figures come from."""
    if window.session.selection:
        return
    nodes = window.session.network.nodes.values()
    electronics = [node.id for node in nodes if node.module in SENSORS]
    window.session.select((electronics or [node.id for node in nodes])[:1])


def settle(window: MainWindow) -> None:
    """Run the event loop until nothing is computed any more and all has been drawn.

    Raises
    ------
    UsageError
        If that takes more than two minutes.
    """
    start = quiet_since = time.monotonic()
    while time.monotonic() - quiet_since < _SETTLE_S:
        QCoreApplication.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 20)
        now = time.monotonic()
        if not window.evaluator.idle:
            quiet_since = now
        if now - start > PATIENCE_S:
            raise UsageError(f"the network takes more than {PATIENCE_S:g} s to compute")
        time.sleep(0.002)


def _image(window: MainWindow, shot: Shot) -> QImage:
    """The part as it looks; the picture alone as its viewer would write it."""
    if shot.part == "picture":
        return _picture(window, shot.size)
    parts: dict[str, QWidget] = {
        "window": window,
        "canvas": window.canvas,
        "panel": window.panels,
        "curves": window.viewers.plot,
    }
    return parts[shot.part].grab().toImage()


def _picture(window: MainWindow, size: tuple[int, int]) -> QImage:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        window.viewers.images[1].save_as(file)
        picture = QImage(str(file))
    if picture.width() > size[0] or picture.height() > size[1]:
        smooth = Qt.TransformationMode.SmoothTransformation
        picture = picture.scaled(QSize(*size), Qt.AspectRatioMode.KeepAspectRatio, smooth)
    return picture


def encoded(image: QImage) -> bytes:
    """As PNG.

    Raises
    ------
    FileError
        If nothing can be drawn.
    """
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "window.png"
        if not image.save(str(file)):
            raise FileError("the window cannot be drawn: no picture came of it")
        return file.read_bytes()
