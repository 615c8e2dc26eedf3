"""The window: the parts put together, and what passes between them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from PySide6.QtCore import QPointF, Qt, QTimer
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QApplication, QMainWindow, QVBoxLayout, QWidget

from app.editor.canvas.canvas import Canvas
from app.editor.canvas.crumbs import Crumbs
from app.editor.evaluation.evaluator import Evaluator
from app.editor.level import Level
from app.editor.library_view import LibraryView
from app.editor.panels.panel_area import PanelArea
from app.editor.recovery_files import Autosaver
from app.editor.session import Session
from app.editor.theme import THEMES, Look, Theme
from app.editor.viewers.network_ports import PLOT_TYPES
from app.editor.viewers.plot.figures_strip import FiguresStrip
from app.editor.window.actions.action_specs import CANVAS_MENU, NODE_MENU
from app.editor.window.actions.action_targets import targets
from app.editor.window.actions.edit_commands import EditCommands
from app.editor.window.actions.focus import go_to_next
from app.editor.window.actions.help import Help
from app.editor.window.actions.menu_actions import Actions
from app.editor.window.background.background_runs import BackgroundRuns
from app.editor.window.docks.dock_toggles import add_dock_toggles, follow_docks
from app.editor.window.docks.fit_dock import FitDock
from app.editor.window.docks.full_screen import FullScreen
from app.editor.window.docks.history_list import HistoryList
from app.editor.window.docks.measure_dock import MeasureDock
from app.editor.window.docks.snapshot_dock import SnapshotDock
from app.editor.window.docks.viewer_docks import FirstViews, ViewerDocks, add_dock, stand_behind
from app.editor.window.docks.window_layout import Docks, LayoutName, WindowLayout, first_size
from app.editor.window.documents.drops import Drops
from app.editor.window.documents.files import Files
from app.editor.window.documents.preset_shelf import PresetShelf
from app.editor.window.documents.recent_files import RecentMenu, Settings
from app.editor.window.documents.recovery import Recovery
from app.editor.window.documents.welcome import WelcomePage
from app.editor.window.pages import Pages, StatusBar
from core.errors import ImagechainError
from core.modules.declaration import Library

_LEFT, _RIGHT = Qt.DockWidgetArea.LeftDockWidgetArea, Qt.DockWidgetArea.RightDockWidgetArea


class MainWindow(QMainWindow):
    """One window with one document.

    Parameters
    ----------
    library : mapping
        Modules by key.
    settings : Settings
        What is remembered.
    recovery : Path
        Folder for work that no file holds yet.
    remembered : bool
        Whether to take size and docks from the settings, and leave them there.
    """

    def __init__(
        self, *, library: Library, settings: Settings, recovery: Path, remembered: bool = True
    ) -> None:
        super().__init__()
        self.setObjectName("window")
        self.settings = settings
        self.session = Session(library, self)
        self.level = Level(self.session, self)
        self.theme: Theme = THEMES[settings.look]
        QApplication.setPalette(self.theme.palette())  # what is built now takes its colours from it
        self.evaluator = Evaluator(self.session, parent=self)
        self._remembered = remembered
        self._ended = False
        self._build(library)
        self.canvas.show_thumbnails(self.evaluator)
        self.files = Files(self.session, settings, self)
        self.edits = EditCommands(self.level, self.canvas, self)
        self.help = Help(self.session, self.viewers, lambda: self.actions_by_name, self)
        self.shelf = PresetShelf(
            self.level, self.canvas, self.library_view, settings.path.parent / "presets", self
        )
        self.panels.sets_folder = self.shelf.folder / "parameters"
        self.drops = Drops(self.level, self.files, self.canvas, self)
        self.full_screen = FullScreen(self.viewers, self.session, self)
        self.actions_by_name = Actions(targets(self), window=self, canvas=self.canvas)
        self.viewers.set_picture_actions(
            self.actions_by_name["full_screen"], self.actions_by_name["export"]
        )
        self.kept.follow_actions(self.actions_by_name)
        for name in ("minimap", "thumbnails"):
            self.actions_by_name[name].setChecked(True)
        self.layout_in_use.place()
        self.menus = self.actions_by_name.fill(self.menuBar())
        self._add_dock_toggles()
        self.recent_menu = RecentMenu(settings, self.files.open, self._show_lists, self)
        self.recent_menu.stand_after(self.actions_by_name["open"], self.menus["&File"])
        self.canvas.set_menus(
            self.actions_by_name.of_names(NODE_MENU), self.actions_by_name.of_names(CANVAS_MENU)
        )
        self.autosaver = Autosaver(self.session, recovery, self)
        self.recovery = Recovery(recovery, self.autosaver, self)
        self._connect()
        self.set_theme(self.theme)
        self.resize(first_size(self.screen().availableSize()))
        if remembered:
            with self.layout_in_use.placing():
                has_sizes = settings.restore_window(self)
                stand_behind(self, self.viewers.plot_dock, self.history_dock)
                stand_behind(self, self.measuring.dock, self.fitting.dock)
            # Where a layout is remembered, it sizes the docks.
            self.pages.sizes_remembered = has_sizes and not self.layout_in_use.restore(
                settings.layout
            )
        self.show_welcome()
        self._follow_state()
        self._follow_level()

    def set_theme(self, theme: Theme) -> None:
        """Draw everything in these colours."""
        self.theme = theme
        app = QApplication.instance()
        if isinstance(app, QApplication):
            app.setPalette(theme.palette())
        parts = (self.canvas, self.crumbs, self.library_view)
        for part in (*parts, self.history, self.status):
            part.set_theme(theme)
        self.viewers.set_theme(theme)
        self.runs.set_theme(theme)
        self.measuring.set_theme(theme)
        self.fitting.set_theme(theme)
        self.actions_by_name["light"].setChecked(theme.look == "light")

    def toggle_light(self) -> None:
        """From dark to light, or back; remembered."""
        look: Look = "dark" if self.theme.look == "light" else "light"
        self.settings.look = look
        self.set_theme(THEMES[look])

    def open_first(self, text: str) -> None:
        """Open a network in place of the first page, and say what is offered there."""
        if self.files.open_now(text) and (left := self.recovery.unsaved_work()):
            names = dict.fromkeys(each.original.name if each.original else "" for each in left)
            of = ", ".join(name or "a network never saved" for name in names)
            self._warn(f"unsaved work was left behind, of {of}: see File > Welcome Page")

    def show_welcome(self) -> None:
        """Show the first page."""
        self.status.forget()
        self._show_lists()
        self.pages.show_first()

    def _show_lists(self) -> None:
        self.welcome.show_lists(self.settings.recent, self.recovery.unsaved_work())

    def show_canvas(self) -> None:
        """Show the network."""
        self.pages.show_work()
        self.canvas.setFocus()

    def choose_layout(self, name: LayoutName) -> None:
        """Place the docks by a named layout."""
        self.full_screen.leave()
        self.pages.choose_layout(name)

    def go_to_part(self, step: int) -> None:
        """Give the focus to the next part of the window that is there, for the keyboard."""
        beside = (self.viewers.plot, self.viewers.tradeoff, self.kept.view)
        viewers = [*self.viewers.images.values(), *beside, self.runs.view, self.measuring.view]
        viewers += [self.fitting.view, self.history]
        sides = self.library_view, self.panels
        go_to_next([self.welcome, self.canvas, *sides, *viewers], step)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Close, unless work would be lost: then ask first, and change nothing until answered."""
        self.full_screen.leave()  # a question brings this window before it, its viewer missing
        if not self._ended and self.files.has_unsaved_work():
            event.ignore()
            self.files.ask_to_save(self._close_with_runs)
        elif not self._ended and self.runs.go_on(self.close_for_good):
            event.ignore()
        else:
            self._end()
            event.accept()

    def _close_with_runs(self) -> None:
        """Close, once it is answered whether what runs in the background is to end."""
        if not self.runs.go_on(self.close_for_good):
            self.close_for_good()

    def finish_typing(self) -> None:
        """Take what was typed and not taken yet, wherever that is."""
        self.canvas.finish_typing()
        self.panels.finish_typing()

    def stop(self) -> ImagechainError | None:
        """Close because the process has to end: unsaved work stays to be recovered.

        Returns what went wrong where it could not be kept.
        """
        if self._ended:  # it may be called again before the process has ended
            return None
        self.finish_typing()
        problem = self.autosaver.keep()
        self.close_for_good()
        return problem

    def close_for_good(self) -> None:
        """Close without a question; what runs is stopped, nothing is left to recover."""
        self._end()
        self.close()

    def _end(self) -> None:
        """Shut everything down, once it is certain that the window closes."""
        if self._ended:
            return
        self._ended = True
        self.full_screen.close()
        self.pages.show_docks()
        if self._remembered:
            self.settings.remember_window(self, self.layout_in_use.state())
        # Dialogs, docks that float: the process goes on while one is shown.
        for other in self.findChildren(QWidget):
            if other.isWindow():
                other.hide()
        self.runs.close()
        self.measuring.close()
        self.fitting.close()
        self.help.handbook.close()
        self.autosaver.close()
        self.evaluator.close()  # last: Python may collect in any thread afterwards

    def _build(self, library: Library) -> None:
        self.canvas = Canvas(self.level, self.theme)
        self.crumbs = Crumbs(self.level, self.theme, self.canvas)
        self.library_view = LibraryView(library)
        self.panels = PanelArea(self.session, self.evaluator)
        self.figures = FiguresStrip(self.session, self.evaluator)
        self.welcome = WelcomePage(library)
        self.status = StatusBar(self.theme, self)
        self.setStatusBar(self.status)
        work_page = QWidget()
        layout = QVBoxLayout(work_page)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(0)
        layout.addWidget(self.canvas, 1)
        layout.addWidget(self.figures)
        self.layout_in_use = WindowLayout(self, self._docks)
        self.pages = Pages(self.welcome, work_page, self.layout_in_use, self)
        self.setCentralWidget(self.pages)
        self.setDockNestingEnabled(True)
        self.setCorner(Qt.Corner.BottomRightCorner, _RIGHT)
        self.setCorner(Qt.Corner.TopRightCorner, _RIGHT)
        self.library_dock = add_dock(self, "Library", "dock.library", self.library_view, _LEFT)
        self.panel_dock = add_dock(self, "Control panels", "dock.panels", self.panels, _RIGHT)
        self.viewers = ViewerDocks(self.session, self.evaluator, self.theme, self)
        self.history = HistoryList(self.session)
        self.history_dock = add_dock(self, "History", "dock.history", self.history, _RIGHT)
        self.history_dock.hide()
        self.kept = SnapshotDock(self.session, self.evaluator, self.viewers, self)
        self.runs = BackgroundRuns(self.session, self.theme, self, self.finish_typing)
        self.measuring = MeasureDock(self.session, self.theme, self.viewers, self)
        parts = (self.measuring, self.viewers, self, self.finish_typing)
        self.fitting = FitDock(self.session, self.theme, *parts)

    def _docks(self) -> Docks:
        viewers = self.viewers
        return Docks(
            library=self.library_dock,
            panels=self.panel_dock,
            curves=viewers.plot_dock,
            tradeoff=viewers.tradeoff_dock,
            snapshots=self.kept.dock,
            runs=self.runs.dock,
            history=self.history_dock,
            measuring=self.measuring.dock,
            fitting=self.fitting.dock,
            viewers=tuple(viewers.docks.values()),
            picture=viewers.images[1],
        )

    def _add_dock_toggles(self) -> None:
        viewers = self.viewers
        sides = (self.library_dock, self.panel_dock, viewers.plot_dock)
        docks = (*sides, self.measuring.dock, *viewers.docks.values())
        add_dock_toggles(self.menus["&View"], docks, viewers)
        named = {
            "trade_off": viewers.tradeoff_dock,
            "runs": self.runs.dock,
            "history": self.history_dock,
            "fit": self.fitting.dock,
        }
        follow_docks(self.actions_by_name, named)
        self.runs.dock.visibilityChanged.connect(viewers.name_tabs)

    def _connect(self) -> None:
        session, evaluator = self.session, self.evaluator
        session.message.connect(self.status.report)
        self.level.opened.connect(self._follow_level)
        session.changed.connect(self._changed)
        session.opened.connect(self._opened)
        session.state_changed.connect(self._follow_state)
        session.selection_changed.connect(self._follow_selection)
        self.files.opened.connect(self.show_canvas)
        self.files.about_to_save.connect(self.finish_typing)
        self.autosaver.failed.connect(self._warn)
        evaluator.badges_changed.connect(self._badges_changed)
        evaluator.busy_changed.connect(self.status.show_busy)
        evaluator.behind_changed.connect(self.status.show_behind)
        FirstViews(session, evaluator, self.viewers)
        self.status.cancel_wanted.connect(evaluator.cancel)
        self.library_view.chosen.connect(self._chosen_in_library)
        self.canvas.activated.connect(self._activated)
        self.canvas.files_dropped.connect(self._files_dropped)
        self.panels.view_requested.connect(self._view_requested)
        self.panels.generate_requested.connect(self.generate)
        self.panels.handbook_requested.connect(self.help.handbook_of)
        self.panels.trade_off_requested.connect(self.viewers.trade_off)
        welcome = self.welcome
        welcome.chosen.connect(self.files.open)
        welcome.new_wanted.connect(self.files.new)
        welcome.open_wanted.connect(self.files.open_dialog)
        welcome.recovered.connect(self._recover)
        welcome.discarded.connect(self._discard)

    def _opened(self) -> None:
        self.viewers.forget_pictures()
        self.status.forget()
        # Once the canvas has its place: it may not have been shown yet.
        QTimer.singleShot(0, self.canvas.frame_all)

    def _changed(self, *_: object) -> None:
        self.status.forget()
        if self.pages.at_first:
            self.show_canvas()

    def _follow_state(self) -> None:
        document = self.session.document
        name = document.path.name if document.path else self.session.network.name or "untitled"
        self.setWindowTitle(f"{name}[*] — Imagechain")
        if document.modified != self.isWindowModified():  # Qt signals it in any case
            self.setWindowModified(document.modified)
        self.actions_by_name.follow_history(document.history)

    def _badges_changed(self, badges: Any) -> None:
        head = self.level.head
        inside = {n.removeprefix(head): b for n, b in badges.items() if n.startswith(head)}
        self.canvas.set_badges(inside)
        self.panels.set_badges(badges)

    def _follow_selection(self, names: tuple[str, ...]) -> None:
        self.actions_by_name.follow_selection(bool(names))
        self.status.forget_advice()

    def _follow_level(self) -> None:
        self.actions_by_name["leave_macro"].setEnabled(bool(self.level.path))
        self._badges_changed(self.evaluator.badges)

    def _activated(self, name: str) -> None:
        if self.level.is_macro(name):
            self.level.enter(name)
            return
        self.level.select([name])
        self.panel_dock.show()
        self.panel_dock.raise_()

    def _chosen_in_library(self, key: str) -> None:
        if not self.shelf.add(key):
            self.drops.add_module(key)

    def _files_dropped(self, paths: list[str], point: QPointF) -> None:
        self.drops.files(paths, (point.x(), point.y()))

    def _view_requested(self, node: str, port: str, number: int) -> None:
        declared = self.session.declared(node)
        output = declared.output(port) if declared is not None else None
        if output is not None and output.types[0] in PLOT_TYPES:
            self.viewers.plot_port(f"{node}.{port}")
        else:
            self.viewers.look_at(number, f"{node}.{port}")

    def generate(self, *_: object) -> None:
        """Compute all afresh, with what is still being typed."""
        self.panels.finish_typing()
        self.evaluator.generate()

    def cancel(self) -> None:
        """Stop the computation."""
        self.evaluator.cancel()
        self.measuring.cancel()
        self.fitting.cancel()

    def _warn(self, text: str) -> None:
        self.status.report("error", text)

    def _recover(self, work: object) -> None:
        self.recovery.open(work, self.files)

    def _discard(self, work: object) -> None:
        self.recovery.discard(work)
