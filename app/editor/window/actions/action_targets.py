"""What each action of the window does."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Protocol

from app.editor.canvas.canvas import Canvas
from app.editor.evaluation.evaluator import Evaluator
from app.editor.gestures import without_argument
from app.editor.level import Level
from app.editor.panels.panel_area import PanelArea
from app.editor.session import Session
from app.editor.viewers.network_ports import VIEWER_NUMBERS
from app.editor.window.actions.edit_commands import EditCommands
from app.editor.window.actions.help import Help
from app.editor.window.background.background_runs import BackgroundRuns
from app.editor.window.docks.fit_dock import FitDock
from app.editor.window.docks.full_screen import FullScreen
from app.editor.window.docks.history_list import HistoryList
from app.editor.window.docks.measure_dock import MeasureDock
from app.editor.window.docks.snapshot_dock import SnapshotDock
from app.editor.window.docks.viewer_docks import ViewerDocks
from app.editor.window.docks.window_layout import DEFAULT, LayoutName
from app.editor.window.documents.files import Files
from app.editor.window.documents.preset_shelf import PresetShelf
from core.editing.layout import EDGES, WAYS

Target = Callable[[], object]


class Window(Protocol):
    """The parts of the window that actions are carried out by."""

    session: Session
    level: Level
    files: Files
    edits: EditCommands
    canvas: Canvas
    help: Help
    panels: PanelArea
    viewers: ViewerDocks
    evaluator: Evaluator
    full_screen: FullScreen
    shelf: PresetShelf
    kept: SnapshotDock
    history: HistoryList
    runs: BackgroundRuns
    measuring: MeasureDock
    fitting: FitDock

    def show_welcome(self) -> None:
        """Show the first page."""

    def close(self) -> bool:
        """Close the window; False where the person wants to stay."""

    def go_to_part(self, step: int) -> None:
        """Move the focus to the next part of the window, or the one before."""

    def choose_layout(self, name: LayoutName) -> None:
        """Place the docks by a named layout."""

    def toggle_light(self) -> None:
        """Change between dark and light."""

    def generate(self) -> None:
        """Compute what is held back."""

    def cancel(self) -> None:
        """Stop what runs."""


def targets(window: Window) -> dict[str, Target]:
    """By the actions' names."""
    session, files, edits, canvas = window.session, window.files, window.edits, window.canvas
    by_name: dict[str, Callable[..., object]] = {
        "new": files.new,
        "open": files.open_dialog,
        "save": files.save,
        "save_as": files.save_as,
        "export": window.help.export,
        "report": window.runs.report,
        "welcome": window.show_welcome,
        "quit": window.close,
        "undo": session.undo,
        "redo": session.redo,
        "cut": edits.cut,
        "copy": edits.copy,
        "paste": edits.paste,
        "copy_values": partial(_typed_first, window, edits.copy_values),
        "paste_values": partial(_typed_first, window, edits.paste_values),
        "duplicate": edits.duplicate,
        "delete": edits.delete,
        "select_all": edits.select_all,
        "rename": window.panels.edit_name,
        "disable": edits.disable,
        "mark_output": edits.mark_output,
        "add_module": canvas.open_search,
        "connect": canvas.connect_selected,
        "backdrop": edits.backdrop,
        "note": edits.note,
        "wire_dot": canvas.add_dot,
        "find_node": canvas.find_node,
        **{f"align_{edge}": partial(edits.align, edge) for edge in EDGES},
        **{f"distribute_{way}": partial(edits.distribute, way) for way in WAYS},
        "thumbnails": canvas.toggle_thumbnails,
        "minimap": canvas.minimap.toggle,
        "group": partial(_group, window),
        "ungroup": edits.ungroup,
        "save_preset": window.shelf.save,
        "leave_macro": window.level.leave,
        "frame": edits.frame,
        "arrange": edits.arrange,
        "zoom_in": partial(canvas.zoom_by, 1.25),
        "zoom_out": partial(canvas.zoom_by, 0.8),
        "trade_off": window.viewers.toggle_trade_off,
        "history": window.history.toggle,
        "fit": window.fitting.toggle,
        "full_screen": window.full_screen.toggle,
        "picture_below": partial(window.choose_layout, "picture_below"),
        "picture_beside": partial(window.choose_layout, "picture_beside"),
        "canvas_first": partial(window.choose_layout, "canvas_first"),
        "reset_layout": partial(window.choose_layout, DEFAULT),
        "next_part": partial(window.go_to_part, 1),
        "previous_part": partial(window.go_to_part, -1),
        "light": window.toggle_light,
        "generate": window.generate,
        "runs": window.runs.toggle,
        "add_run": window.runs.add,
        "measure": window.measuring.measure,
        "cancel": window.cancel,
        "keep_snapshot": partial(_typed_first, window, window.kept.comparing.keep),
        "flip": window.kept.snapshots.flip,
        "wipe": window.kept.snapshots.wipe,
        "go_back": window.kept.snapshots.go_back,
        "snapshots": window.kept.toggle,
        "shortcuts": window.help.shortcuts,
        "module_help": window.help.module,
        "handbook": window.help.handbook.open,
        "about": window.help.about,
    }
    for number in VIEWER_NUMBERS:
        by_name[f"view_{number}"] = partial(_view, window, number)
    return {name: partial(without_argument, target) for name, target in by_name.items()}


def _group(window: Window) -> None:
    """Group, and have the macro's name typed in its panel."""
    steps = window.session.document.history.position
    window.edits.group()
    if window.session.document.history.position != steps:
        window.panels.edit_name()


def _typed_first(window: Window, target: Target) -> None:
    """Take what is being typed, then do it."""
    window.panels.finish_typing()
    target()


def _view(window: Window, number: int) -> None:
    for name in window.session.selection[-1:]:
        window.viewers.look_at_node(name, number)
