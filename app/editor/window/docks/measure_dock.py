"""The measuring dock in the window: what it measures, and where its results go."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from PySide6.QtCore import QObject, Qt
from PySide6.QtWidgets import QApplication, QMainWindow

from app.editor.docks.measure_view import MeasureView
from app.editor.docks.measure_worker import picture_of, shown_in
from app.editor.session import Session
from app.editor.theme import Theme
from app.editor.window.docks.viewer_docks import ViewerDocks, add_dock
from app.editor.window.documents.drops import choose_pictures, show_beside
from app.editor.window.documents.files import SaveDialog
from core.errors import UsageError
from nodes.files.common.file_format import CSV, HTML, JSON, dialog_filter

_KINDS = ";;".join(
    (dialog_filter("Page", HTML), dialog_filter("Everything", JSON), dialog_filter("MTF", CSV))
)


class MeasureDock(QObject):
    """Measures what viewers show, or files, in a dock that is hidden until it is wanted.

    Parameters
    ----------
    session, theme
        As for the viewers.
    viewers : ViewerDocks
        Viewers whose pictures are measured.
    window : QMainWindow
        The window.
    """

    def __init__(
        self, session: Session, theme: Theme, viewers: ViewerDocks, window: QMainWindow
    ) -> None:
        super().__init__(window)
        self._viewers = viewers
        self._window = window
        self._in_front = False
        self.view = MeasureView(theme)
        area = Qt.DockWidgetArea.BottomDockWidgetArea
        self.dock = add_dock(window, "Measure", "dock.measure", self.view, area)
        self.dock.hide()
        self.dock.visibilityChanged.connect(viewers.name_tabs)
        self.dock.visibilityChanged.connect(self._shown)
        self.view.file_wanted.connect(self.choose_file)
        self.view.export_wanted.connect(self.choose_target)
        self.view.message.connect(session.message)
        self.view.viewer.menu().aboutToShow.connect(self._list_viewers)
        self._session = session
        session.changed.connect(lambda *_: self.view.network_changed(session.document.network))
        session.opened.connect(self.view.forget_network)

    def set_theme(self, theme: Theme) -> None:
        """Draw in other colours."""
        self.view.set_theme(theme)

    def measure(self) -> None:
        """Measure what the viewer with the focus shows, or the first that shows something.

        A measurement of files that is out of sight is brought to the front first: edges may have
        been chosen in it by hand.
        """
        before = isinstance(self.view.source, tuple) and not self._in_front
        self.show()
        if before:
            return
        focus = QApplication.focusWidget()
        shown = shown_in(self._viewers.images)
        for number in shown:
            if focus is not None and self._viewers.images[number].isAncestorOf(focus):
                self.measure_viewer(number)
                return
        self.measure_viewer(shown[0] if shown else 1)

    def measure_viewer(self, number: int) -> None:
        """Measure what a viewer shows."""
        try:
            picture = picture_of(number, self._viewers.images[number])
        except UsageError as error:
            self.view.status.show_text(str(error), failed=True)
            return
        self.view.measure_viewer(picture, self._session.document.network)

    def show(self) -> None:
        """Bring the dock to the front."""
        self.dock.show()
        self.dock.raise_()
        self.view.canvas.setFocus(Qt.FocusReason.OtherFocusReason)

    def cancel(self) -> None:
        """Stop measuring."""
        self.view.cancel()

    def close(self) -> None:
        """Stop measuring, and wait for its end."""
        self.view.close_worker()

    def choose_file(self) -> None:
        """Ask the person for a picture."""
        choose_pictures(
            self._window, "Measure pictures of one camera", name="measure_dialog",
            chosen=self.view.measure_files,
        )  # fmt: skip

    def choose_target(self) -> None:
        """Ask the person where the results go."""
        dialog = SaveDialog(self._window, "Write the measurement", str(Path.cwd()), _KINDS)
        dialog.setObjectName("measure_export_dialog")
        dialog.setDefaultSuffix(HTML.suffixes[0].removeprefix("."))
        dialog.selectFile("measured.html")
        dialog.fileSelected.connect(lambda text: self.view.export(Path(text)))
        show_beside(self._window, dialog)

    def _shown(self, on: bool) -> None:
        self._in_front = on

    def _list_viewers(self) -> None:
        menu = self.view.viewer.menu()
        menu.clear()
        shown = shown_in(self._viewers.images)
        for number in shown:
            port = self._viewers.images[number].choices.port
            action = menu.addAction(f"Viewer &{number}: {port}")
            action.setObjectName(f"measure.viewer_{number}")
            action.triggered.connect(partial(self._measure_listed, number))
        if not shown:
            menu.addAction("No viewer shows a picture").setEnabled(False)

    def _measure_listed(self, number: int, _checked: bool = False) -> None:
        self.measure_viewer(number)
