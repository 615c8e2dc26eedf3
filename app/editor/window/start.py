"""From the command line to the window."""

import signal
import sys
import tempfile
import threading
import time
from functools import partial
from pathlib import Path

from PySide6 import QtCore, QtGui
from PySide6.QtWidgets import QApplication, QWidget

from app.editor.qt_libraries import nothing_collected
from app.editor.theme import THEMES, Look
from app.editor.viewers.plot.plot_export import png_bytes
from app.editor.window.files import open_named
from app.editor.window.main_window import MainWindow
from app.editor.window.recent_files import Settings
from app.run.terminal import print_error
from app.tradeoff.tradeoff_results import SENSORS
from app.user_folders import FOLDERS
from core.atomic import write_bytes
from core.errors import FileError, ImagechainError, UsageError
from nodes.library import missing_modules, standard_library

FIRST = "mwir_camera"  # opened at the very first start: a whole camera at work

_WAKE_MS = 200  # Python handles a signal only while its code runs


def application() -> QApplication:
    app = QApplication.instance()
    if not isinstance(app, QApplication):
        app = QApplication(["imagechain"])
    app.setApplicationName("imagechain")
    app.setApplicationDisplayName("Imagechain")
    app.setStyle("Fusion")
    return app


def start(
    stop_requested: threading.Event,
    network: str,
    *,
    look: Look | None = None,
    size: tuple[int, int] | None = None,
    screenshot: Path | None = None,
    part: str = "window",
) -> None:
    """Open the window and stay until it is closed, or draw it to a file.

    On a signal to end it closes without a question: unsaved work is kept to be recovered.
    """
    app = application()
    QtCore.qInstallMessageHandler(lambda *_: None)  # its own remarks are for its developers
    if screenshot is not None:
        take(app, network, screenshot, size or (1600, 900), look or "dark", part)
        return
    _only_note(stop_requested)
    settings = Settings()
    with nothing_collected():
        window = built(settings, network, look, size)
    sys.excepthook = partial(_report, window)
    app.commitDataRequest.connect(lambda _manager: window.autosaver.write())
    problem: ImagechainError | None = None

    def end_on_request() -> None:
        nonlocal problem
        if stop_requested.is_set():
            problem = window.stop() or problem

    wake = QtCore.QTimer()
    wake.timeout.connect(end_on_request)
    wake.start(_WAKE_MS)
    with nothing_collected():
        show_painted(window)
    for line in missing_modules(window.session.library):
        window.session.message.emit("error", line)
    if not stop_requested.is_set():  # else a loop without a window would have no end
        app.exec()
    end_on_request()
    if problem is not None:
        stop_requested.clear()  # it was carried out: the error is the outcome
        raise FileError(f"unsaved work is lost: {problem}") from problem


def built(
    settings: Settings,
    network: str = "",
    look: Look | None = None,
    size: tuple[int, int] | None = None,
) -> MainWindow:
    """The window, with a network in it where one is named or no settings are there yet."""
    recovery = FOLDERS.user_data_path / "recovery"
    window = MainWindow(library=standard_library(), settings=settings, recovery=recovery)
    if look is not None:
        window.set_theme(THEMES[look])
    if size is not None:
        window.setWindowState(QtCore.Qt.WindowState.WindowNoState)
        window.resize(*size)
    elif settings.first:
        window.setWindowState(QtCore.Qt.WindowState.WindowMaximized)
    if first := network or (FIRST if settings.first else ""):
        window.open_first(first)
    return window


def show_painted(window: MainWindow) -> None:
    """Show the window once it is painted: until then a compositor draws it black."""
    window.setWindowOpacity(0.0)
    window.show()
    handle, end = window.windowHandle(), time.monotonic() + _SETTLE_S
    while not handle.isExposed() and time.monotonic() < end:
        QtCore.QCoreApplication.processEvents(
            QtCore.QEventLoop.ProcessEventsFlag.ExcludeUserInputEvents, 20
        )
    window.repaint()
    window.setWindowOpacity(1.0)


def _only_note(stop_requested: threading.Event) -> None:
    """Only note a signal to end: an exception in a slot would not reach the caller."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # Windows has no SIGHUP
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, lambda *_: stop_requested.set())


def _report(
    window: MainWindow, kind: type[BaseException], error: BaseException, _trace: object
) -> None:
    """An internal error in a slot becomes one line; the window goes on."""
    line = f"internal error: {kind.__name__}: {' '.join(str(error).split())}"
    print_error(f"imagechain: {line}")
    window.session.message.emit("error", line)


# Drawing the window to a file without a display, for documentation and checks.

PATIENCE_S = 120.0
_SETTLE_S = 0.4  # queued answers and repaints after the last pass


def take(
    app: QApplication, network: str, file: Path, size: tuple[int, int], look: Look, part: str
) -> None:
    """Draw a network, or the welcome page, in a window off screen once all is computed."""
    library = standard_library()
    opened = open_named(network, library=library) if network else None
    with tempfile.TemporaryDirectory() as folder:
        settings = Settings(Path(folder) / "settings.ini")
        settings.look = look
        with nothing_collected():
            window = MainWindow(
                library=library, settings=settings, recovery=Path(folder), remembered=False
            )
        try:
            window.resize(*size)
            if opened is not None:
                window.files.show(*opened)
            window.show()
            settle(window)
            if opened is not None:
                _select_node_with_figures(window)
                settle(window)
            parts: dict[str, QWidget] = {
                "window": window,
                "canvas": window.canvas,
                "panel": window.panels,
                "curves": window.viewers.plot,
            }
            drawn = parts[part].grab().toImage() if part in parts else _picture(window, size)
            write_bytes(file, png_bytes(drawn))
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
    """Run the event loop until nothing is computed any more and all has been drawn."""
    start = quiet_since = time.monotonic()
    while time.monotonic() - quiet_since < _SETTLE_S:
        QtCore.QCoreApplication.processEvents(QtCore.QEventLoop.ProcessEventsFlag.AllEvents, 20)
        now = time.monotonic()
        idle = window.evaluator.idle
        if not idle:
            quiet_since = now
        if now - start > PATIENCE_S:
            raise UsageError(f"the network takes more than {PATIENCE_S:g} s to compute")
        time.sleep(0.02 if idle else 0.002)


def _picture(window: MainWindow, size: tuple[int, int]) -> QtGui.QImage:
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        window.viewers.images[1].export(file)
        picture = QtGui.QImage(str(file))
    if picture.width() > size[0] or picture.height() > size[1]:
        smooth = QtCore.Qt.TransformationMode.SmoothTransformation
        picture = picture.scaled(
            QtCore.QSize(*size), QtCore.Qt.AspectRatioMode.KeepAspectRatio, smooth
        )
    return picture
