"""From the command line to the window."""

from __future__ import annotations

import signal
import sys
import threading
from types import TracebackType

from PySide6.QtCore import QTimer, qInstallMessageHandler
from PySide6.QtWidgets import QApplication

from app.editor.lean_imports import nothing_collected
from app.editor.theme import THEMES
from app.editor.window.documents.remembered_settings import Settings
from app.editor.window.main_window import MainWindow
from app.editor.window.screenshot import Shot, take
from app.options.command_options import Options
from app.options.terminal_streams import print_error
from app.user_folders import data_folder
from core.errors import FileError, ImagechainError
from nodes.library import standard_library
from nodes.plug_ins import missing_modules

FIRST = "first_steps"  # opened at the very first start

_WAKE_MS = 200  # Python handles a signal only while its code runs


def application() -> QApplication:
    """The one QApplication, in our style."""
    app = QApplication.instance()
    if not isinstance(app, QApplication):
        app = QApplication(["imagechain"])
    app.setApplicationName("imagechain")
    app.setApplicationDisplayName("Imagechain")
    app.setStyle("Fusion")
    return app


def start(options: Options, stop_requested: threading.Event) -> None:
    """Open the window and stay until it is closed, or draw it to a file.

    On a signal to end it closes without a question: unsaved work is kept to be recovered.

    Raises
    ------
    ImagechainError
        If a screenshot cannot be made, or unsaved work cannot be kept.
    """
    app = application()
    qInstallMessageHandler(_quiet)
    if options.screenshot is not None:
        size, look = options.window_size or (1600, 900), options.look or "dark"
        shot = Shot(options.screenshot, size, look, options.part)
        take(app, options.network, shot)
        return
    _only_note(stop_requested)
    settings = Settings()
    with nothing_collected():
        window = built(options, settings)
    sys.excepthook = _Reporter(window)
    app.commitDataRequest.connect(lambda _manager: window.autosaver.write())
    ending = _Ending(window, stop_requested)
    wake = QTimer()
    wake.timeout.connect(ending)
    wake.start(_WAKE_MS)
    with nothing_collected():
        window.show()
    for line in missing_modules(window.session.library):
        window.session.message.emit("error", line)
    app.exec()
    if ending.problem is not None:
        stop_requested.clear()  # it was carried out: the error is the outcome
        raise FileError(f"unsaved work is lost: {ending.problem}") from ending.problem


def built(options: Options, settings: Settings) -> MainWindow:
    """The window, with a network in it where one is named or no settings are there yet."""
    recovery = data_folder() / "recovery"
    window = MainWindow(library=standard_library(), settings=settings, recovery=recovery)
    if options.look is not None:
        window.set_theme(THEMES[options.look])
    if options.window_size is not None:
        window.resize(*options.window_size)
    if network := options.network or (FIRST if settings.first else ""):
        window.open_first(network)
    return window


class _Ending:
    """Lets Python handle signals, and closes the window after one; work is kept."""

    def __init__(self, window: MainWindow, stop_requested: threading.Event) -> None:
        self.problem: ImagechainError | None = None
        self._window = window
        self._stop_requested = stop_requested

    def __call__(self) -> None:
        if self._stop_requested.is_set():
            self.problem = self._window.stop() or self.problem


def _only_note(stop_requested: threading.Event) -> None:
    """Only note a signal to end: an exception in a slot would not reach the caller."""
    for name in ("SIGINT", "SIGTERM", "SIGHUP"):  # Windows has no SIGHUP
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, lambda *_: stop_requested.set())


class _Reporter:
    """An internal error in a slot becomes one line; the window goes on."""

    def __init__(self, window: MainWindow) -> None:
        self._window = window

    def __call__(
        self, kind: type[BaseException], error: BaseException, _trace: TracebackType | None
    ) -> None:
        line = f"internal error: {kind.__name__}: {' '.join(str(error).split())}"
        print_error(f"imagechain: {line}")
        self._window.session.message.emit("error", line)


def _quiet(*_: object) -> None:
    """Qt's own remarks are for its developers."""
