"""The window: the parts put together, and what passes between them."""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, get_args

from PySide6.QtCore import Qt, QTimer
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QApplication, QDockWidget, QMainWindow, QMenu, QVBoxLayout, QWidget

from app.editor import library_view, messages, recovery_files, widgets
from app.editor.canvas.canvas import Canvas, Crumbs
from app.editor.docks.fit_view import FitView
from app.editor.docks.measure_view import MeasureView
from app.editor.docks.snapshots import HistoryList, Snapshots, SnapshotsView
from app.editor.evaluation.evaluator import Evaluator
from app.editor.panels.panel_area import PanelArea
from app.editor.session import Level, Session
from app.editor.theme import THEMES, Look, Theme
from app.editor.viewers.plot.figures_strip import FiguresStrip
from app.editor.viewers.viewer import PLOT_TYPES, VIEWER_NUMBERS
from app.editor.window import background_runs, viewer_docks
from app.editor.window.actions import (
    ACTIONS,
    CANVAS_MENU,
    NODE_MENU,
    EditCommands,
    filled_menus,
    made_actions,
)
from app.editor.window.files import Drops, Files, PresetShelf
from app.editor.window.help import Help
from app.editor.window.recent_files import DOCKS_VERSION, Settings, recent_menu
from app.editor.window.welcome import WelcomePage
from app.editor.window.window_layout import DEFAULT, LayoutName, Pages, WindowLayout, layout_menu
from core.editing.layout import EDGES, WAYS
from core.errors import ImagechainError
from core.modules.declaration import Library

_LEFT, _RIGHT = Qt.DockWidgetArea.LeftDockWidgetArea, Qt.DockWidgetArea.RightDockWidgetArea
_LAID_OUT_MS = 50  # until docks that come back have their places
_LEAST_CANVAS = 8  # lines of text, in which a chain can still be followed


class MainWindow(QMainWindow):
    """One window with one document.

    `recovery` is the folder for work that no file holds yet; `remembered` says whether size and
    docks are those of the settings, and left there.
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
        self._recovery = recovery
        self._remembered = remembered
        self._ended = False
        self._build(library)
        self.files = Files(self.session, settings, self)
        self.edits = EditCommands(self.level, self.canvas)
        self.help = Help(self.session, self.viewers, self)
        self.shelf = PresetShelf(
            self.level,
            self.canvas,
            self.library_view,
            settings.path.parent / "presets",
            self.evaluator,
        )
        self.panels.sets_folder = self.shelf.folder / "parameters"
        self.panels.illustrations = settings.illustrations
        self.panels.illustrations_changed.connect(partial(setattr, settings, "illustrations"))
        self.drops = Drops(self.level, self.files, self.canvas, self)
        self.full_screen = viewer_docks.FullScreen(self.viewers, self.session, self)
        self.focus_ring = viewer_docks.FocusRing(self.parts, self)
        self.actions_by_name = made_actions(self._targets(), window=self, canvas=self.canvas)
        self._spread_actions()
        self.layout_in_use.choose(DEFAULT)
        self.menus = filled_menus(self.menuBar(), self.actions_by_name)
        self._add_dock_toggles(self.menus["&View"])
        self.layout_menu = layout_menu(settings, self.layout_in_use, self.workbench)
        self.menus["&View"].insertMenu(self.actions_by_name["reset_layout"], self.layout_menu)
        self.recent_menu = recent_menu(settings, self.files.open, self._show_lists, self)
        file_actions = self.menus["&File"].actions()
        after_open = file_actions[file_actions.index(self.actions_by_name["open"]) + 1]
        self.menus["&File"].insertMenu(after_open, self.recent_menu)
        self.autosaver = recovery_files.Autosaver(self.session, recovery, self)
        self.file_watch = recovery_files.FileWatch(self.session, recovery, self)
        self._connect()
        self.set_theme(self.theme)
        self.resize(self.screen().availableSize() * 0.92)  # once it is not maximised
        if remembered:
            geometry, docks, layout = settings.window
            self.restoreGeometry(geometry)
            self.layout_in_use.restore(docks, layout)
        self.show_welcome()
        self._follow_state()
        self._follow_level()

    def set_theme(self, theme: Theme) -> None:
        self.theme = theme
        QApplication.setPalette(theme.palette())
        self.actions_by_name["light"].setChecked(theme.look == "light")

    def toggle_light(self) -> None:
        look: Look = "dark" if self.theme.look == "light" else "light"
        self.settings.look = look
        self.set_theme(THEMES[look])

    def open_first(self, text: str) -> None:
        """Open a network in place of the first page, and say what is offered there."""
        if self.files.open_now(text) and (left := recovery_files.recoverable(self._recovery)):
            names = dict.fromkeys(each.original.name if each.original else "" for each in left)
            of = ", ".join(name or "an unsaved network" for name in names)
            self.status.report(
                "warning", f"unsaved work in {of} can be recovered: see File > New from…"
            )

    def toggle_welcome(self) -> None:
        if self.pages.at_first and self.pages.has_worked:
            self.show_canvas()
        else:
            self.show_welcome()

    def show_welcome(self) -> None:
        self.status.forget(closed=True)
        network = self.session.network
        self.welcome.offer_back((network.name or "the network") if network.nodes else "")
        self._show_lists()
        self.pages.setCurrentWidget(self.welcome)

    def _show_lists(self) -> None:
        self.welcome.show_lists(self.settings.recent, recovery_files.recoverable(self._recovery))

    def show_canvas(self) -> None:
        self.pages.show_work()
        self.canvas.setFocus()

    def choose_layout(self, name: LayoutName) -> None:
        self.full_screen.leave()
        self.layout_in_use.choose(name)

    def parts(self) -> tuple[QWidget, ...]:
        """The parts of the window that can have the keyboard, in the order of F6."""
        beside = (self.viewers.plot, self.viewers.tradeoff, self.snapshots_view, self.runs.view)
        docks = (*self.viewers.images.values(), *beside, self.measuring, self.fitting, self.history)
        return self.welcome, self.canvas, self.library_view, self.panels, *docks

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
        if not self.runs.go_on(self.close_for_good):
            self.close_for_good()

    def finish_typing(self) -> None:
        self.canvas.title_editor.finish()
        self.panels.finish_typing()

    def stop(self) -> ImagechainError | None:
        """Close as the process has to end: unsaved work stays to be recovered, or why it cannot."""
        if self._ended:  # it may be called again before the process has ended
            return None
        self.finish_typing()
        problem = self.autosaver.keep()
        self.close_for_good()
        return problem

    def close_for_good(self) -> None:
        self._end()
        self.close()

    def _end(self) -> None:
        if self._ended:
            return
        self._ended = True
        self.full_screen.leave()
        self.focus_ring.end()
        self.layout_in_use.make_room(empty=False)
        if self._remembered:
            docks = self.workbench.saveState(DOCKS_VERSION)
            layout = self.layout_in_use.state()
            self.settings.remember_window(self.saveGeometry(), docks, layout)
        # Dialogs, docks that float: the process goes on while one is shown.
        for other in self.findChildren(QWidget):
            if other.isWindow():
                other.hide()
        self.runs.queue.close()
        self.measuring.end_work()
        self.fitting.end_work()
        self.help.close()
        self.autosaver.close()
        self.file_watch.close()
        self.evaluator.close()  # last: Python may collect in any thread afterwards

    def _build(self, library: Library) -> None:
        self.canvas = Canvas(self.level, self.evaluator)
        self.crumbs = Crumbs(self.level, self.canvas)
        self.library_view = library_view.LibraryView(library)
        self.panels = PanelArea(self.session, self.evaluator)
        self.figures = FiguresStrip(self.session, self.evaluator)
        self.welcome = WelcomePage()
        self.status = messages.StatusBar(self.menuBar())
        self.canvas.setMinimumHeight(_LEAST_CANVAS * self.fontMetrics().height())
        self.workbench = workbench = QMainWindow(flags=Qt.WindowType.Widget)
        workbench.setObjectName("workbench")
        workbench.setCentralWidget(QWidget())
        middle = QVBoxLayout(workbench.centralWidget())
        widgets.filled(middle, (self.canvas, 1), self.figures, spacing=0)
        workbench.setDockNestingEnabled(True)
        workbench.setCorner(Qt.Corner.BottomRightCorner, _RIGHT)
        workbench.setCorner(Qt.Corner.TopRightCorner, _RIGHT)
        self.pages = Pages(self)
        self.pages.addWidget(self.welcome)
        self.pages.addWidget(workbench)
        self.setCentralWidget(self.pages)
        self.library_dock = viewer_docks.add_dock(
            workbench, "Library", "library", self.library_view, _LEFT
        )
        self.panel_dock = viewer_docks.add_dock(
            workbench, "Control panels", "panels", self.panels, _RIGHT
        )
        self.viewers = viewer_docks.ViewerDocks(self.session, self.evaluator, workbench)
        hidden_dock = partial(viewer_docks.add_dock, workbench, hidden=True)
        self.history = HistoryList(self.session)
        self.history_dock = hidden_dock("History", "history", self.history, _RIGHT)
        self.snapshots = Snapshots(
            self.session, self.evaluator, self.viewers.images, self.viewers.plot, self
        )
        self.viewers.made.connect(lambda _: self.snapshots.follow())
        self.snapshots_view = SnapshotsView(self.session, self.evaluator, self.snapshots)
        self.snapshots_dock = hidden_dock("Snapshots", "snapshots", self.snapshots_view)
        self.runs = background_runs.BackgroundRuns(self.session, workbench, self.finish_typing)
        self.measuring = measuring = MeasureView(self.session, self.viewers.images)
        self.measure_dock = hidden_dock("Measure", "measure", measuring)
        self.fitting = FitView(self.session, lambda: measuring.source, self.finish_typing)
        self.fit_dock = hidden_dock("Fit", "fit", self.fitting)
        self.fit_dock.visibilityChanged.connect(self.fitting.show_state)
        measuring.source_changed.connect(self.fitting.show_state)
        self.layout_in_use = WindowLayout(workbench)
        for dock in workbench.findChildren(QDockWidget):
            self._follow_dock(dock)
        # Docks that an action shows and hides, and what in them gets the keyboard.
        self.tools: dict[str, tuple[QDockWidget, QWidget]] = {
            "trade_off": (self.viewers.tradeoff_dock, self.viewers.tradeoff.parameter),
            "history": (self.history_dock, self.history),
            "fit": (self.fit_dock, self.fitting.file),
            "runs": (self.runs.dock, self.runs.view),
            "snapshots": (self.snapshots_dock, self.snapshots_view.list),
        }
        self.viewers.made.connect(self._follow_dock)

    def _follow_dock(self, dock: Any) -> None:
        self.layout_in_use.follow(dock)
        dock.visibilityChanged.connect(self.viewers.name_tabs)

    def _targets(self) -> dict[str, Callable[..., object]]:
        session, files, edits, canvas = self.session, self.files, self.edits, self.canvas
        snapshots = self.snapshots
        return {
            **{name: getattr(files, name) for name in ("new", "save", "save_as")},
            "open": files.open_dialog,
            "export": self.help.export,
            "report": self.runs.report,
            "welcome": self.toggle_welcome,
            "quit": self.close,
            "undo": session.undo,
            "redo": session.redo,
            **{one.name: getattr(edits, one.name) for one in ACTIONS if hasattr(edits, one.name)},
            "copy_values": partial(self._typed_first, edits.copy_values),
            "paste_values": partial(self._typed_first, edits.paste_values),
            "rename": self.panels.edit_name,
            "add_module": canvas.open_search,
            "connect": canvas.adding.connect_selected,
            "wire_dot": canvas.add_dot,
            "find_node": canvas.adding.find_node,
            **{f"align_{edge}": partial(edits.line_up, edge) for edge in EDGES},
            **{f"distribute_{way}": partial(edits.line_up, way) for way in WAYS},
            "thumbnails": canvas.thumbnails.toggle,
            "minimap": canvas.minimap.toggle,
            "group": self._group,
            "save_preset": self.shelf.save,
            "leave_macro": self.level.leave,
            "frame_all": canvas.frame_all,
            "zoom_in": partial(canvas.zoom_by, 1.25),
            "zoom_out": partial(canvas.zoom_by, 0.8),
            **{name: partial(self._toggle, *tool) for name, tool in self.tools.items()},
            "full_screen": self.full_screen.toggle,
            **{name: partial(self.choose_layout, name) for name in get_args(LayoutName)},
            "reset_layout": partial(self.choose_layout, DEFAULT),
            "next_part": partial(self.focus_ring.go, 1),
            "previous_part": partial(self.focus_ring.go, -1),
            "light": self.toggle_light,
            "generate": self.generate,
            "add_run": self.runs.add,
            "measure": self._measure,
            "cancel": self.cancel,
            "keep_snapshot": partial(self._typed_first, snapshots.keep),
            "flip": partial(snapshots.compare, "flip"),
            "wipe": partial(snapshots.compare, "wipe"),
            "go_back": snapshots.go_back,
            "shortcuts": lambda: self.help.shortcuts(self.actions_by_name),
            "module_help": self.help.module,
            "handbook": self.help.open_handbook,
            "about": self.help.about,
            **{f"view_{number}": partial(self._view, number) for number in VIEWER_NUMBERS},
        }

    def _spread_actions(self) -> None:
        actions, viewers = self.actions_by_name, self.viewers
        compare = [actions[name] for name in ("keep_snapshot", "flip", "wipe")]
        viewers.offer([actions["full_screen"], actions["export"]], compare)
        for widget in (self.snapshots_view.list, self.snapshots_view.figures):
            widget.addActions(compare)
        for name in ("flip", "wipe", "frame", "minimap", "thumbnails"):  # they change no network
            self.panels.addAction(actions[name])
        of_node, of_canvas = ([actions[name] for name in one] for one in (NODE_MENU, CANVAS_MENU))
        self.canvas.menus.fill(of_node, of_canvas)
        for name in ("minimap", "thumbnails"):
            actions[name].setChecked(True)
        for name, (dock, _) in self.tools.items():
            dock.visibilityChanged.connect(actions[name].setChecked)

    def _add_dock_toggles(self, menu: QMenu) -> None:
        viewers = self.viewers
        menu.addSeparator()
        sides = (self.library_dock, self.panel_dock, viewers.plot_dock)
        for dock in (*sides, self.measure_dock, *viewers.docks.values()):
            menu.addAction(dock.toggleViewAction())
        viewers.made.connect(lambda dock: menu.addAction(dock.toggleViewAction()))

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
        self.autosaver.failed.connect(partial(self.status.report, "error"))
        evaluator.badges_changed.connect(self._badges_changed)
        evaluator.busy_changed.connect(self.status.show_busy)
        evaluator.behind_changed.connect(self.status.show_behind)
        viewer_docks.FirstViews(session, evaluator, self.viewers)
        self.status.cancel_wanted.connect(evaluator.cancel)
        self.library_view.chosen.connect(self._chosen_in_library)
        self.canvas.surface.activated.connect(self._activated)
        self.canvas.surface.view_wanted.connect(lambda _: self._view(1))
        self.canvas.surface.files_dropped.connect(self.drops.files)
        panels = self.panels
        panels.view_wanted.connect(self._view_requested)
        panels.generate_wanted.connect(self.generate)
        panels.named.connect(self.canvas.setFocus)
        panels.handbook_wanted.connect(self.help.handbook_of)
        panels.trade_off_wanted.connect(self.viewers.trade_off)
        welcome = self.welcome
        welcome.chosen.connect(self.files.open)
        welcome.new_wanted.connect(self.files.new)
        welcome.open_wanted.connect(self.files.open_dialog)
        welcome.back_wanted.connect(self.show_canvas)
        welcome.recovered.connect(
            lambda work: self.files.after_asking(lambda: self._show_recovered(work))
        )

    def _opened(self) -> None:
        self.viewers.forget_pictures()
        self.status.forget(closed=True)
        self._make_room(empty=not self.session.network.nodes)
        # Once the canvas has its place: it may not have been shown yet.
        QTimer.singleShot(0, self.canvas.view, self.canvas.frame_all)

    def _changed(self, *_: object) -> None:
        self.status.forget()
        if self.session.network.nodes:
            self._make_room(empty=False)
        if self.pages.at_first:
            self.show_canvas()

    def _make_room(self, *, empty: bool) -> None:
        if not empty and self.layout_in_use.lacks_docks:  # the first node stays in sight
            view, content = self.canvas.view, self.canvas.content
            QTimer.singleShot(_LAID_OUT_MS, view, lambda: view.make_visible(content.bounds()))
        self.layout_in_use.make_room(empty=empty)
        self.figures.setHidden(empty)

    def _follow_state(self) -> None:
        document = self.session.document
        name = document.path.name if document.path else self.session.network.name or "untitled"
        self.setWindowTitle(f"{name}[*] — Imagechain")
        if document.modified != self.isWindowModified():  # Qt signals it in any case
            self.setWindowModified(document.modified)
        for name, step in (("undo", document.undo_text), ("redo", document.redo_text)):
            action = self.actions_by_name[name]
            action.setEnabled(bool(step))
            action.setText(f"&{name.capitalize()} {step.replace('&', '&&')}".strip())

    def _badges_changed(self, badges: Any) -> None:
        head = self.level.head
        inside = {n.removeprefix(head): b for n, b in badges.items() if n.startswith(head)}
        self.canvas.set_badges(inside)
        self.panels.set_badges(badges)

    def _follow_selection(self, names: tuple[str, ...]) -> None:
        if names:
            self.layout_in_use.show_panels()
        for spec in ACTIONS:
            if spec.selected:
                self.actions_by_name[spec.name].setEnabled(bool(names))
        if alike := self.session.selected_alike:
            text = (
                f"{len(alike)} nodes of the same module are selected: a new value applies to all "
                "of them"
            )
            self.session.message.emit("note", text)

    def _follow_level(self) -> None:
        self.actions_by_name["leave_macro"].setEnabled(bool(self.level.path))
        self._badges_changed(self.evaluator.badges)

    def _activated(self, name: str) -> None:
        if self.level.is_macro(name):
            self.level.enter(name)
            return
        self.level.select([name])
        viewer_docks.bring_forward(self.panel_dock)

    def _chosen_in_library(self, key: str) -> None:
        if not self.shelf.add(key, self.canvas.surface.cursor_point()):
            self.canvas.add_module(key)

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
        self.evaluator.cancel()
        self.measuring.cancel()
        self.fitting.cancel()

    def _typed_first(self, target: Callable[[], object]) -> None:
        self.panels.finish_typing()
        target()

    def _group(self) -> None:
        document = self.session.document
        steps = document.position
        self.edits.group()
        if document.position != steps:
            self.panels.edit_name()

    def _view(self, number: int) -> None:
        for name in self.session.selection[-1:]:
            self.viewers.look_at_node(name, number)

    def _toggle(self, dock: QDockWidget, focus: QWidget) -> None:
        if viewer_docks.in_front(dock):
            dock.hide()
        else:
            self.pages.show_work()
            viewer_docks.bring_forward(dock, focus)

    def _measure(self) -> None:
        """Measure what a viewer shows, unless files were measured that are out of sight.

        Those are brought to the front first: edges may have been chosen in them by hand.
        """
        before = isinstance(self.measuring.source, tuple) and not viewer_docks.in_front(
            self.measure_dock
        )
        self.pages.show_work()
        viewer_docks.bring_forward(self.measure_dock, self.measuring.canvas)
        if not before:
            self.measuring.measure_shown()

    def _show_recovered(self, work: recovery_files.Recovered) -> None:
        """Open it as unsaved; its file stays until the window has written its own."""
        with messages.told(self.status.report, "not recovered: "):
            document = work.document(self.session.library)
            self.files.show(document, "recovered: save the network if you want to keep it")
            self.autosaver.write_now(work.discard)
