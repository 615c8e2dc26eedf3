"""Every action of the window: menu, keys, what it does. Menus and lists are made from these."""

from collections.abc import Callable, Collection, Iterable, Mapping
from functools import partial
from typing import Any, Literal

from PySide6.QtCore import Qt
from PySide6.QtGui import QAction, QGuiApplication, QKeySequence
from PySide6.QtWidgets import QMenu, QMenuBar, QWidget

from app.editor.canvas.canvas import Canvas
from app.editor.canvas.mouse import remove_dot
from app.editor.messages import told
from app.editor.panels.fields.field import copy_values, paste_values
from app.editor.session import Level
from app.editor.viewers.viewer import VIEWER_NUMBERS
from app.editor.widgets import Menu
from core.editing.backdrops import (
    Backdrop,
    add,
    around,
    dots_of,
    laid_out,
    moved_with_dots,
    straighten,
)
from core.editing.clipboard import copied, duplicated, pasted
from core.editing.layout import WAYS, Edge, Point, Way, aligned, arranged, distributed
from core.editing.macros import group, ungroup
from core.editing.operations import (
    Operation,
    keeping_values,
    move_nodes,
    output_toggled,
    rewire,
    set_node_field,
    together,
)
from core.editing.wiring import detached, dissolved
from core.records import dataclass

Scope = Literal["application", "window", "canvas"]


@dataclass(frozen=True)
class ActionSpec:
    """One action, with its text in a menu, its tooltip and its keys, the first one shown.

    Keys of `scope` "application" work everywhere, in dialogs and open menus too; of "window" in the
    window; of "canvas" while the canvas has the focus: single letters must not interfere with lists
    and fields elsewhere.
    """

    menu: str
    name: str
    text: str
    tip: str
    keys: tuple[str, ...] = ()
    scope: Scope = "window"
    checkable: bool = False
    selected: bool = False  # it works on the selected nodes


def _action(menu: str, name: str, text: str, tip: str, *keys: str, **more: Any) -> ActionSpec:
    return ActionSpec(menu, name, text, tip, keys, **more)


_file, _edit, _view = (partial(_action, menu) for menu in ("&File", "&Edit", "&View"))
_run, _compare, _help = (partial(_action, menu) for menu in ("&Run", "&Compare", "&Help"))
_selected = partial(_edit, scope="canvas", selected=True)

# fmt: off
ACTIONS: tuple[ActionSpec, ...] = (
    _file("new", "&New", "Start an empty network", "Ctrl+N"),
    _file("welcome", "New &from…",
          "Show example networks, recent files and recovered work; press again to return",
          "Ctrl+Shift+N"),
    _file("open", "&Open…", "Open a network file", "Ctrl+O"),
    _file("save", "&Save", "Save the network", "Ctrl+S"),
    _file("save_as", "Save &As…", "Save the network to another file", "Ctrl+Shift+S"),
    _file("export", "&Export…", "Save the contents of the last used viewer", "Ctrl+E"),
    _file("report", "Re&port…",
          "Write a report of the network's current state as an HTML page",
          "Ctrl+Shift+R"),
    _file("quit", "&Quit", "Close the window", "Ctrl+Q", scope="application"),
    _edit("undo", "&Undo", "Undo the last step", "Ctrl+Z"),
    _edit("redo", "&Redo", "Redo the last undone step", "Ctrl+Shift+Z", "Ctrl+Y"),
    _selected("cut", "Cu&t",
              "Move the selected nodes to the clipboard, and reconnect the wires around them",
              "Ctrl+X"),
    _selected("copy", "&Copy", "Copy the selected nodes as JSON", "Ctrl+C"),
    _edit("paste", "&Paste", "Paste nodes from the clipboard at the pointer", "Ctrl+V",
          scope="canvas"),
    _edit("copy_values", "Copy &Values", "Copy the values of the selected node as JSON",
          "Ctrl+Shift+C", selected=True),
    _edit("paste_values", "Paste Va&lues",
          "Apply the copied values to the same parameters of the selected nodes",
          "Ctrl+Shift+V", selected=True),
    _selected("duplicate", "D&uplicate", "Copy the selected nodes and place the copies beside them",
              "Ctrl+D"),
    _edit("delete", "&Delete",
          "Delete the selected nodes or wire; reconnect the chain around deleted nodes",
          "Del", "Backspace", scope="canvas"),
    _selected("detach", "Detac&h",
              "Disconnect the selected nodes and keep them; a chain is reconnected around them",
              "Ctrl+Shift+X"),
    _edit("select_all", "Select &All", "Select every node", "Ctrl+A", scope="canvas"),
    _selected("rename", "Re&name", "Rename the selected node", "F2"),
    _selected("disable", "D&isable", "Make the selected nodes pass their input through unchanged",
              "D"),
    _selected("mark_output", "Mark as &Output",
              "Make the selected node's picture the output of the network, or unmark it", "O"),
    _edit("add_module", "Add &Module…", "Search for a module and add it", "Tab", scope="canvas"),
    _selected("connect", "Conn&ect…", "Choose ports to connect the selected node", "C"),
    _edit("backdrop", "Add &Backdrop",
          "Put a titled backdrop behind the selected nodes; if none is selected, at the pointer",
          "B", scope="canvas"),
    _edit("note", "Add No&te", "Put a note at the pointer", "N", scope="canvas"),
    _edit("wire_dot", "Bend Wi&re",
          "Add a dot to bend the wire at the pointer, or the selected wire", "R",
          scope="canvas"),
    _edit("find_node", "&Find Node…", "Find a node by its name", "Ctrl+F"),
    _selected("align_left", "Align Le&ft", "Align the left edges of the selected nodes",
              "Alt+Left"),
    _selected("align_right", "Align Ri&ght", "Align the right edges of the selected nodes",
              "Alt+Right"),
    _selected("align_top", "Align &Top", "Align the upper edges of the selected nodes", "Alt+Up"),
    _selected("align_bottom", "Align Botto&m", "Align the lower edges of the selected nodes",
              "Alt+Down"),
    _selected("distribute_across", "Distribute Acr&oss", "Make the horizontal gaps equal",
              "Alt+Shift+H"),
    _selected("distribute_down", "Distribute Do&wn", "Make the vertical gaps equal",
              "Alt+Shift+V"),
    _selected("group", "&Group", "Combine the selected nodes into a macro", "Ctrl+G"),
    _selected("ungroup", "Un&group", "Replace the selected macro with its nodes",
              "Ctrl+Shift+G"),
    _edit("save_preset", "Save as Pre&set",
          "Add the selected macro to the library for use in any network", selected=True),
    _view("frame", "&Frame", "Show the selected nodes; if none is selected, all",
          "F", scope="canvas"),
    _view("frame_all", "Frame &All", "Show all nodes", "Home", scope="canvas"),
    _view("arrange", "&Lay Out", "Arrange the selected nodes; if none is selected, all",
          "L", scope="canvas"),
    _view("minimap", "&Map", "Show a map if the network is larger than the canvas", "M",
          scope="canvas", checkable=True),
    _view("thumbnails", "T&humbnails", "Show small pictures and curves of the nodes' outputs",
          "T", scope="canvas", checkable=True),
    _view("leave_macro", "Leave &Macro", "Leave this macro and show the network around it",
          "Alt+PgUp"),
    _view("zoom_in", "Zoom &In", "Enlarge the canvas", "Ctrl++", "Ctrl+="),
    _view("zoom_out", "Zoom &Out", "Shrink the canvas", "Ctrl+-"),
    _view("trade_off", "&Trade-off", "Plot figures of merit against a parameter", "Ctrl+T",
          checkable=True),
    _view("history", "Hi&story", "List the steps that you can undo and redo", "Ctrl+H",
          checkable=True),
    _view("fit", "F&it to a Picture",
          "Fit parameters to the edges of a real picture (right-click a number to free it)",
          "Ctrl+Shift+F", checkable=True),
    _view("full_screen", "F&ull Screen",
          "Show the last used viewer in full screen; press F11 again or Esc to return", "F11"),
    _view("picture_below", "Picture &Below", "Layout: the chain as a strip above the picture"),
    _view("picture_beside", "Picture Be&side",
          "Layout: the picture on the left, everything else on the right"),
    _view("canvas_first", "&Canvas First", "Layout: a large canvas with small viewers below"),
    _view("reset_layout", "&Reset Layout",
          "Return all parts of the window to their default places"),
    _view("next_part", "&Next Part", "Go to the next part of the window", "F6"),
    _view("previous_part", "&Previous Part", "Go to the previous part of the window", "Shift+F6"),
    _view("light", "Li&ght Colours", "Switch between light and dark colours", checkable=True),
    _run("generate", "&Generate Image",
         "Compute everything again, including nodes that are not updated",
         "Ctrl+Return", "Ctrl+Enter"),
    _run("runs", "&Runs in the Background",
         "Show the queue of sweeps, frames and lists of pictures", "Ctrl+Shift+T", checkable=True),
    _run("add_run", "&Add to the Queue…", "Add a sweep, frames or pictures to the queue"),
    _run("measure", "&Measure Picture",
         "Measure edges, MTF and noise in a viewer's picture or in a file", "Ctrl+M"),
    _run("cancel", "&Cancel", "Stop the computation", "Esc"),
    _compare("keep_snapshot", "&Keep Snapshot",
             "Keep the current state as A, to compare with later states", "Ctrl+K"),
    _compare("flip", "&Flip A and B",
             "Switch between the snapshot (A) and the current picture (B)", "K",
             scope="canvas"),
    _compare("wipe", "&Wipe A and B",
             "Show the snapshot (A) left of a divider and the current picture (B) right of it", "W",
             scope="canvas"),
    _compare("go_back", "Go &Back to A",
             "Restore the network from the snapshot; you can undo this"),
    _compare("snapshots", "&Snapshots",
             "List the snapshots and compare their figures with the current ones", "Ctrl+Shift+K",
             checkable=True),
    _help("shortcuts", "&Shortcuts", "List every shortcut", "?", "Ctrl+/"),
    _help("handbook", "&Handbook", "Open the handbook in the browser"),
    _help("module_help", "&Module", "Read about the selected module in the handbook", "F1"),
    _help("about", "&About", "Version and sources"),
    *(_run(f"view_{number}", f"Show in Viewer &{number}",
           f"Show the selected node in viewer {number}", str(number), scope="canvas", selected=True)
      for number in VIEWER_NUMBERS),
)
# fmt: on

BELOW_A_LINE = frozenset(
    {
        *("save", "export", "quit", "cut", "rename", "add_module", "find_node"),
        *("align_left", "group", "zoom_in", "trade_off", "picture_below", "next_part", "light"),
        "view_1",
    }
)
"""What begins a part of its menu."""

NODE_MENU = (
    *("rename", "disable", "mark_output"),
    *("duplicate", "copy", "cut", "delete", "detach", "connect", "group", "ungroup"),
    "save_preset",
    *("copy_values", "paste_values"),
)
"""What the menu of a node on the canvas has of them."""

CANVAS_MENU = ("add_module", "paste", "select_all", "arrange", "frame")
"""What the menu of the empty canvas has."""


# The window's QActions, made of their specifications.

_SCOPES = {
    "application": Qt.ShortcutContext.ApplicationShortcut,
    "window": Qt.ShortcutContext.WindowShortcut,
    "canvas": Qt.ShortcutContext.WidgetWithChildrenShortcut,
}


Actions = dict[str, QAction]  # by their names


def made_actions(
    targets: Mapping[str, Callable[[], object]], *, window: QWidget, canvas: QWidget
) -> Actions:
    actions: Actions = {}
    for spec in ACTIONS:
        action = actions[spec.name] = _made(spec, window, targets[spec.name])
        (canvas if spec.scope == "canvas" else window).addAction(action)
    return actions


def filled_menus(bar: QMenuBar, actions: Actions) -> dict[str, QMenu]:
    menus: dict[str, QMenu] = {}
    for spec in ACTIONS:
        menu = menus.get(spec.menu)
        if menu is None:
            menu = menus[spec.menu] = Menu(spec.menu, bar)
            bar.addMenu(menu)
            menu.setToolTipsVisible(True)
        if spec.name in BELOW_A_LINE and menu.actions():
            menu.addSeparator()
        menu.addAction(actions[spec.name])
    return menus


def _made(spec: ActionSpec, parent: QWidget, act: Callable[[], object]) -> QAction:
    action = QAction(spec.text, parent, checkable=spec.checkable, statusTip=spec.tip)
    action.setObjectName(f"action.{spec.name}")
    action.setToolTip(spec.tip)
    action.setShortcuts([QKeySequence(key) for key in spec.keys])
    action.setShortcutContext(_SCOPES[spec.scope])
    action.triggered.connect(lambda *_: act())  # without whether it is checked
    return action


_NEW_BACKDROP = (360.0, 200.0)  # where no node is selected
_NEW_NOTE = (220.0, 90.0)


class EditCommands:
    """What changes the network in view; an action of a method's name is that method."""

    def __init__(self, session: Level, canvas: Canvas) -> None:
        self._session = session
        self._canvas = canvas

    def _do(self, names: Iterable[str], operation: Operation) -> None:
        if self._session.do(operation):
            self._session.select(names)

    def copy(self) -> None:
        session = self._session
        if session.selection:
            text = copied(session.network, session.selection, session.library)
            QGuiApplication.clipboard().setText(text)

    def cut(self) -> None:
        session = self._session
        if session.selection:
            self.copy()
            self._take_out(dissolved(session.network, session.library, session.selection, "Cut"))

    def paste(self) -> None:
        session, canvas = self._session, self._canvas
        text = QGuiApplication.clipboard().text()
        at, sizes = canvas.surface.cursor_point(), canvas.content.sizes()
        with told(session.message.emit, "nothing was pasted: "):
            self._do(*pasted(text, session.network, library=session.library, at=at, sizes=sizes))

    def copy_values(self) -> None:
        whole = self._session.session
        copy_values(whole, whole.selection)

    def paste_values(self) -> None:
        whole = self._session.session
        if whole.selection:
            paste_values(whole, whole.selection)

    def duplicate(self) -> None:
        session, sizes = self._session, self._canvas.content.sizes()
        if names := session.selection:
            self._do(*duplicated(session.network, names, library=session.library, sizes=sizes))

    def delete(self) -> None:
        """Delete the selected dot or nodes, and lead the wire past them; else wire or backdrop."""
        session, link = self._session, self._canvas.marks.link
        if remove_dot(self._canvas.surface):
            return
        if session.selection:
            self._take_out(dissolved(session.network, session.library, session.selection))
        elif link is not None:
            session.do(rewire(remove=(link,)))
        else:
            self._canvas.menus.delete_backdrop()

    def detach(self) -> None:
        session = self._session
        if session.selection:
            session.do(detached(session.network, session.library, session.selection))

    def _take_out(self, taking: Operation) -> None:
        """Take the selected nodes out; parameters that follow them keep their values."""
        session = self._session
        operation, kept = keeping_values(
            network=session.network, names=session.selection, taking=taking, value_of=session.value
        )
        if session.do(operation) and kept:
            more = f" and {len(kept) - 3} more" if kept[3:] else ""
            session.message.emit(
                "note", f"no longer linked, but values kept: {', '.join(kept[:3])}{more}"
            )

    def select_all(self) -> None:
        self._session.select(self._session.network.nodes)

    def disable(self) -> None:
        nodes = [self._session.network.nodes[name] for name in self._session.selection]
        off = not all(node.disabled for node in nodes)
        steps = [set_node_field(node.id, "disabled", off) for node in nodes if node.disabled != off]
        if steps:
            self._session.do(steps[0] if len(steps) == 1 else together(steps))

    def mark_output(self) -> None:
        session = self._session
        for name in session.selection[-1:]:
            with told(session.message.emit):
                session.do(output_toggled(session.network, session.library, name))

    def group(self) -> None:
        session = self._session
        network, library, names = session.network, session.library, session.selection
        with told(session.message.emit):
            name, operation = group(
                network, library, names, where=session.head, value_of=session.value
            )
            self._do([name], operation)

    def ungroup(self) -> None:
        session = self._session
        for macro in session.selection[-1:]:
            with told(session.message.emit):
                self._do(*ungroup(session.network, session.library, macro, session.head))

    def backdrop(self) -> None:
        session = self._session
        if session.selection:
            operation = around(session.network, session.selection, self._canvas.content.sizes())
        else:
            x, y = self._canvas.surface.cursor_point()
            operation = add(session.network, Backdrop("Backdrop", x, y, *_NEW_BACKDROP))
        if session.do(operation):
            self._canvas.edit_last_title()

    def note(self) -> None:
        x, y = self._canvas.surface.cursor_point()
        operation = add(self._session.network, Backdrop("Note", x, y, *_NEW_NOTE, note=True))
        if self._session.do(operation):
            self._canvas.edit_last_title()

    def arrange(self) -> None:
        """Lay out the selected nodes, or all; long chains in rows of the canvas's width."""
        session, canvas = self._session, self._canvas
        drawn, room = canvas.sizes_with_thumbnails(), canvas.view.natural_room()
        if len(session.selection) > 1:
            places = arranged(session.network, drawn, only=session.selection, room=room)
            session.do(self._without_dots(move_nodes(places, "Lay out"), session.selection))
        elif session.network.nodes:
            moving = laid_out(session.network, canvas.content.sizes(), room, drawn)
            session.do(self._without_dots(moving, session.network.nodes))
        self._canvas.frame_all()

    def _without_dots(self, moving: Operation, names: Collection[str]) -> Operation:
        """Wires at nodes that are laid out find their own way: dots are of another picture."""
        network = self._session.network
        bent = [link for link in dots_of(network) if {link.source, link.target} & set(names)]
        return together((moving, straighten(network, bent)), moving.text) if bent else moving

    def line_up(self, how: Edge | Way) -> None:
        """Align at an edge, or distribute across or down."""
        session, sizes, spread = self._session, self._canvas.content.sizes(), how in WAYS
        places: Callable[..., dict[str, Point]] = distributed if spread else aligned
        label = f"{'Distribute' if spread else 'Align'} {how}"
        points = places(session.network, session.selection, sizes, how)
        if points:
            session.do(moved_with_dots(session.network, dict(points), label))
        else:
            session.message.emit("note", f"{label.lower()}: select two or more nodes")

    def frame(self) -> None:
        if names := self._session.selection:
            self._canvas.view.frame(self._canvas.content.bounds(names))
        else:
            self._canvas.frame_all()
