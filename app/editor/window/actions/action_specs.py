"""Every action of the window: menu, keys, what it does. Menus and lists are made from these."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from app.editor.viewers.network_ports import VIEWER_NUMBERS

Scope = Literal["application", "window", "canvas"]


@dataclass(frozen=True)
class ActionSpec:
    """One action.

    Parameters
    ----------
    name : str
        Its name in the window.
    menu : str
        Menu it stands in.
    text : str
        Its text in the menu.
    tip : str
        What it does, in one line.
    keys : tuple of str
        Its shortcuts, the first one shown.
    scope : "application", "window" or "canvas"
        Whether the keys work everywhere, in dialogs and open menus too; in the window; or only
        while the canvas has the focus: single letters must not interfere with lists and fields
        elsewhere.
    checkable : bool
        Whether it is something that is on or off.
    needs_selection : bool
        Whether it works on the selected nodes.
    """

    name: str
    menu: str
    text: str
    tip: str
    keys: tuple[str, ...] = ()
    scope: Scope = "window"
    checkable: bool = False
    needs_selection: bool = False


def _edit(name: str, text: str, tip: str, *keys: str, selection: bool = True) -> ActionSpec:
    return ActionSpec(name, "&Edit", text, tip, keys, "canvas", needs_selection=selection)


_SEPARATED = frozenset(
    {
        *("save", "export", "welcome", "quit", "cut", "rename", "add_module"),
        *("find_node", "align_left", "group"),
    }
)

ACTIONS: tuple[ActionSpec, ...] = (
    ActionSpec("new", "&File", "&New", "Begin an empty network", ("Ctrl+N",)),
    ActionSpec("open", "&File", "&Open…", "Open a network file", ("Ctrl+O",)),
    ActionSpec("save", "&File", "&Save", "Save the network", ("Ctrl+S",)),
    ActionSpec(
        "save_as", "&File", "Save &As…", "Save the network to another file", ("Ctrl+Shift+S",)
    ),
    ActionSpec("export", "&File", "&Export…", "Write what the last used viewer shows", ("Ctrl+E",)),
    ActionSpec(
        "report",
        "&File",
        "Re&port…",
        "Write a report of the network as it stands, as a page for the browser",
        ("Ctrl+Shift+R",),
    ),
    ActionSpec("welcome", "&File", "&Welcome Page", "Shipped networks, recent files, lost work"),
    ActionSpec("quit", "&File", "&Quit", "Close the window", ("Ctrl+Q",), "application"),
    ActionSpec("undo", "&Edit", "&Undo", "Undo the last step", ("Ctrl+Z",)),
    ActionSpec("redo", "&Edit", "&Redo", "Do again what was undone", ("Ctrl+Shift+Z", "Ctrl+Y")),
    _edit(
        "cut",
        "Cu&t",
        "Take the selected nodes out to the clipboard, and lead wires past them",
        "Ctrl+X",
    ),
    _edit("copy", "&Copy", "Copy the selected nodes as JSON", "Ctrl+C"),
    _edit("paste", "&Paste", "Put the clipboard's nodes at the mouse", "Ctrl+V", selection=False),
    ActionSpec(
        "copy_values",
        "&Edit",
        "Copy &Values",
        "Copy the values of the selected node as JSON",
        ("Ctrl+Shift+C",),
        needs_selection=True,
    ),
    ActionSpec(
        "paste_values",
        "&Edit",
        "Paste Va&lues",
        "Give the selected nodes the copied values that fit them",
        ("Ctrl+Shift+V",),
        needs_selection=True,
    ),
    _edit(
        "duplicate", "D&uplicate", "Copy the selected nodes to free ground beside them", "Ctrl+D"
    ),
    _edit(
        "delete",
        "&Delete",
        "Delete the selected nodes or wire; where there is one way through, it is led past",
        "Del",
        "Backspace",
        selection=False,
    ),
    _edit("select_all", "Select &All", "Select every node", "Ctrl+A", selection=False),
    _edit("rename", "Re&name", "Give the selected node another name", "F2"),
    _edit("disable", "D&isable", "Let the selected nodes pass their input through", "D"),
    _edit(
        "mark_output",
        "Mark as &Output",
        "Make the selected node's picture what the network delivers; again: unmark it",
        "O",
    ),
    _edit("add_module", "Add &Module…", "Search a module and add it", "Tab", selection=False),
    _edit("connect", "Conn&ect…", "Wire the selected node by its ports' names", "C"),
    _edit(
        "backdrop",
        "Add &Backdrop",
        "Put a titled backdrop behind the selected nodes, or at the mouse",
        "B",
        selection=False,
    ),
    _edit("note", "Add No&te", "Put a note at the mouse", "N", selection=False),
    _edit(
        "wire_dot",
        "Bend Wi&re",
        "Put a dot on the wire at the mouse, or the selected one, to bend it through",
        "R",
        selection=False,
    ),
    ActionSpec("find_node", "&Edit", "&Find Node…", "Find a node by its name", ("Ctrl+F",)),
    _edit("align_left", "Align Le&ft", "Left edges of the selected nodes in line", "Alt+Left"),
    _edit("align_right", "Align Ri&ght", "Right edges of the nodes in line", "Alt+Right"),
    _edit("align_top", "Align &Top", "Upper edges of the selected nodes in line", "Alt+Up"),
    _edit("align_bottom", "Align Botto&m", "Lower edges of the nodes in line", "Alt+Down"),
    _edit("distribute_across", "Distribute Acr&oss", "Equal gaps side by side", "Alt+Shift+H"),
    _edit("distribute_down", "Distribute Do&wn", "Equal gaps from top to bottom", "Alt+Shift+V"),
    _edit("group", "&Group", "Make one node of the selected ones: a macro", "Ctrl+G"),
    _edit(
        "ungroup", "Un&group", "Put the nodes of the selected macro in its place", "Ctrl+Shift+G"
    ),
    ActionSpec(
        "save_preset",
        "&Edit",
        "Save as Pre&set",
        "Keep the selected macro, to be found in the library in any network",
        needs_selection=True,
    ),
    ActionSpec("frame", "&View", "&Frame", "Show the selected nodes, or all", ("F",), "canvas"),
    ActionSpec(
        "arrange", "&View", "&Lay Out", "Arrange the selected nodes, or all", ("L",), "canvas"
    ),
    ActionSpec(
        "minimap",
        "&View",
        "&Map",
        "A map of the network where it is larger than the canvas",
        ("M",),
        "canvas",
        checkable=True,
    ),
    ActionSpec(
        "thumbnails",
        "&View",
        "T&humbnails",
        "Small pictures and curves of what comes out of the nodes",
        ("T",),
        "canvas",
        checkable=True,
    ),
    ActionSpec(
        "leave_macro",
        "&View",
        "Leave &Macro",
        "Show what lies around the macro shown",
        ("Alt+PgUp",),
    ),
    ActionSpec("zoom_in", "&View", "Zoom &In", "Enlarge the canvas", ("Ctrl++", "Ctrl+=")),
    ActionSpec("zoom_out", "&View", "Zoom &Out", "Shrink the canvas", ("Ctrl+-",)),
    ActionSpec(
        "trade_off",
        "&View",
        "&Trade-off",
        "Show figures of merit as a parameter moves",
        ("Ctrl+T",),
        checkable=True,
    ),
    ActionSpec(
        "history",
        "&View",
        "Hi&story",
        "List the steps that undo and redo go through",
        ("Ctrl+H",),
        checkable=True,
    ),
    ActionSpec(
        "fit",
        "&View",
        "F&it to a Picture",
        "Fit the free parameters (right-click a number) to the edges of a real picture",
        ("Ctrl+Shift+F",),
        checkable=True,
    ),
    ActionSpec(
        "full_screen",
        "&View",
        "F&ull Screen",
        "Show the viewer used last over the whole screen; again or Esc: back",
        ("F11",),
    ),
    ActionSpec(
        "picture_below", "&View", "Picture &Below", "Layout: the chain as a band above the picture"
    ),
    ActionSpec(
        "picture_beside", "&View", "Picture Be&side", "Layout: the picture left, all else right"
    ),
    ActionSpec(
        "canvas_first", "&View", "&Canvas First", "Layout: a large canvas, small viewers below"
    ),
    ActionSpec("reset_layout", "&View", "&Reset Layout", "Put every part where it was at first"),
    ActionSpec("next_part", "&View", "&Next Part", "Go to the next part of the window", ("F6",)),
    ActionSpec("previous_part", "&View", "&Previous Part", "Go to the part before", ("Shift+F6",)),
    ActionSpec("light", "&View", "Li&ght Colours", "Light or dark", (), checkable=True),
    ActionSpec(
        "generate",
        "&Run",
        "&Generate Image",
        "Compute everything afresh, held nodes too",
        ("Ctrl+Return", "Ctrl+Enter"),
    ),
    ActionSpec(
        "runs",
        "&Run",
        "&Runs in the Background",
        "Show the queue of sweeps, frames and lists of pictures",
        ("Ctrl+Shift+T",),
        checkable=True,
    ),
    ActionSpec("add_run", "&Run", "&Add to the Queue…", "Queue a sweep, frames, or pictures"),
    ActionSpec(
        "measure",
        "&Run",
        "&Measure Picture",
        "Measure edges, MTF and noise of the picture that a viewer shows, or of a file",
        ("Ctrl+M",),
    ),
    ActionSpec("cancel", "&Run", "&Cancel", "Stop the computation", ("Esc",)),
    ActionSpec(
        "keep_snapshot",
        "&Compare",
        "&Keep Snapshot",
        "Keep the present state as A, to compare with what it will be",
        ("Ctrl+K",),
    ),
    ActionSpec(
        "flip",
        "&Compare",
        "&Flip A and B",
        "Show the snapshot, A, in the place of the picture now, B; again: back",
        ("K",),
        "canvas",
    ),
    ActionSpec(
        "wipe",
        "&Compare",
        "&Wipe A and B",
        "Show the snapshot, A, left of a divider and B right of it; again: B alone",
        ("W",),
        "canvas",
    ),
    ActionSpec(
        "go_back",
        "&Compare",
        "Go &Back to A",
        "Make the network what it was in the snapshot; can be undone",
    ),
    ActionSpec(
        "snapshots",
        "&Compare",
        "&Snapshots",
        "List the snapshots, and show their figures beside those of now",
        ("Ctrl+Shift+K",),
        checkable=True,
    ),
    ActionSpec("shortcuts", "&Help", "&Shortcuts", "List every shortcut", ("?", "Ctrl+/")),
    ActionSpec("handbook", "&Help", "&Handbook", "Open the handbook in the browser"),
    ActionSpec("module_help", "&Help", "&Module", "Show what the selected module does", ("F1",)),
    ActionSpec("about", "&Help", "&About", "Version and sources"),
)

NODE_MENU = (
    *("rename", "disable", "mark_output"),
    *("duplicate", "copy", "cut", "delete", "connect", "group", "ungroup"),
    "save_preset",
    *("copy_values", "paste_values"),
)
"""What the menu of a node on the canvas has of them."""

CANVAS_MENU = ("add_module", "paste", "select_all", "arrange", "frame")
"""What the menu of the empty canvas has."""


def viewer_specs() -> tuple[ActionSpec, ...]:
    """One action for each viewer: show the selected node in it."""
    return tuple(
        ActionSpec(
            f"view_{number}",
            "&Run",
            f"Show in Viewer &{number}",
            f"Show the selected node in viewer {number}",
            (str(number),),
            "canvas",
            needs_selection=True,
        )
        for number in VIEWER_NUMBERS
    )


def starts_a_group(spec: ActionSpec) -> bool:
    """Whether a line stands above it in its menu."""
    return spec.name in _SEPARATED or spec.name in (
        "view_1",
        "zoom_in",
        "trade_off",
        "picture_below",
        "next_part",
        "light",
    )
