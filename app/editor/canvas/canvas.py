"""The canvas: the picture of the document's network, its menus and its keys."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, Qt, Signal
from PySide6.QtGui import QAction, QContextMenuEvent, QKeyEvent
from PySide6.QtWidgets import QHBoxLayout, QMenu, QToolButton, QVBoxLayout, QWidget

from app.editor import declared_text, widgets
from app.editor.canvas.adding import Adding, ChoicePopup
from app.editor.canvas.canvas_style import COLOUR, TINTS, CanvasStyle
from app.editor.canvas.canvas_view import GraphView, Minimap
from app.editor.canvas.content import Content, Hit, node_at
from app.editor.canvas.mouse import Mouse, add_dot, backdrop_at, moved_together, nudge_dot
from app.editor.canvas.node_item import BackdropItem
from app.editor.canvas.node_thumbnails import NodeThumbnails
from app.editor.canvas.placing import Dropping, Surface
from app.editor.evaluation.evaluator import Evaluator
from app.editor.panels.fields.type_in import TypeIn
from app.editor.session import Level
from app.editor.theme import FAINT, RAISED, raised_palette, theme_of
from core.editing.backdrops import backdrops_of, change, moved_with_dots, nodes_on, remove
from core.editing.operations import ABSENT, named, rewire, set_node_field, together
from core.records import replace

_TYPE = QEvent.Type


class Canvas(QWidget):
    """Shows the session's network and follows it; gestures become operations on the document."""

    def __init__(self, session: Level, evaluator: Evaluator) -> None:
        super().__init__()
        widgets.labelled(self, "canvas", "Canvas")
        self._style = style = CanvasStyle(theme_of(self), self.font())
        self._session = session
        self.view = GraphView(style, self)
        self.setFocusProxy(self.view)
        self.content = Content(self.view.scene(), session.library, style)
        self.surface = surface = Surface(session, self.view, self.content, self)
        self.marks = surface.marks
        self._hint = widgets.labelled(
            widgets.centred_hint(TEXT, self.view.viewport()), "canvas.empty_hint"
        )
        self._hint.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
        self._hint.setForegroundRole(FAINT)
        widgets.filled(QVBoxLayout(self.view.viewport()), self._hint)
        self.minimap = Minimap(self.view, self.content)
        self.popup = ChoicePopup(self.view)
        self.title_editor = TitleEditor(self.view)
        self.adding = Adding(surface, self.popup)
        self.mouse = self.view.mouse = Mouse(surface, self.adding.ask_for_wire)
        self.view.keys = Keys(surface)
        self.menus = self.view.menus = Menus(surface, self)
        self.view.dropping = Dropping(surface)
        widgets.filled(QVBoxLayout(self), self.view)
        self._connect()
        self.thumbnails = NodeThumbnails(session, evaluator, self.view.scene(), self.content)
        self._take_look()
        self._opened()

    # For the window's actions

    def set_badges(self, badges: Any) -> None:
        self.content.set_badges(dict(badges))

    def frame_all(self) -> None:
        self.view.frame(self.content.bounds().united(self.thumbnails.bounds()))

    def zoom_by(self, factor: float) -> None:
        pos = self.surface.pointer
        self.view.zoom_at(factor, None if pos is None else QPointF(pos))

    def node_or_thumbnail_at(self, point: QPointF) -> str | None:
        node = node_at(self.content, point)
        return node.id if node is not None else self.thumbnails.node_at(point)

    def sizes_with_thumbnails(self) -> dict[str, tuple[float, float]]:
        below = self.thumbnails.heights()
        return {
            name: (width, height + below.get(name, 0.0))
            for name, (width, height) in self.content.sizes().items()
        }

    def add_module(self, key: str) -> None:
        self.adding.add(key, self.surface.cursor_point())

    def open_search(self) -> None:
        self.adding.search(self.surface.cursor_point())

    def edit_last_title(self) -> None:
        self._edit_title(len(self.content.backdrops) - 1)

    def add_dot(self) -> None:
        add_dot(self.surface, self.surface.pointer)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() in (_TYPE.FontChange, _TYPE.PaletteChange) and hasattr(self, "thumbnails"):
            self._take_look()

    def _take_look(self) -> None:
        theme, style = theme_of(self), self._style
        if not style.is_of(theme, self.font()):  # to measure letters takes long
            style = self._style = CanvasStyle(theme, self.font())
        self.content.set_style(style)
        self.thumbnails.set_style(style)
        self.view.set_style(style)
        self.minimap.update()
        self.popup.setPalette(raised_palette(theme))

    def _connect(self) -> None:
        session, surface = self._session, self.surface
        session.opened.connect(self._opened)
        session.changed.connect(self._changed)
        session.selection_changed.connect(self._selection_changed)
        surface.search_wanted.connect(lambda at: self.adding.search((at.x(), at.y())))
        surface.title_wanted.connect(self._edit_title)
        self.title_editor.edited.connect(self._retitle)

    def _opened(self) -> None:
        self._changed(opened=True)
        self.content.mark_selected(self._session.selection)
        self.frame_all()

    def _changed(self, *_: object, opened: bool = False) -> None:
        # What is under way was about a network that is no more.
        self.mouse.cancel()
        self.adding.dismiss()
        self.title_editor.dismiss()
        if opened:
            self.content.clear()
        self.content.follow(self._session.network)
        self._hint.setVisible(not self._session.network.nodes)
        self.minimap.follow()

    def _selection_changed(self, names: tuple[str, ...]) -> None:
        if names:
            self.marks.choose(None, None)
        self.content.mark_selected(names)
        self.minimap.follow()

    def _edit_title(self, index: int) -> None:
        self.title_editor.edit(self.content.backdrops[index])

    def _retitle(self, index: int, title: str) -> None:
        network = self._session.network
        backdrop = replace(backdrops_of(network)[index], title=title)
        self._session.do(change(network, index, backdrop))


TEXT = "Press Tab or double-click to add a module, drag one from the library, or drop a file"


class Menus:
    def __init__(self, surface: Surface, parent: QWidget) -> None:
        self._surface, self._marks = surface, surface.marks
        self.node_menu = _menu("canvas.menu.node", parent)
        self.canvas_menu = _menu("canvas.menu.canvas", parent)
        self.wire_menu = _menu("canvas.menu.wire", parent)
        self.backdrop_menu = _menu("canvas.menu.backdrop", parent)
        self._colours = _menu("canvas.menu.colours", parent, "Co&lour")
        for name in ("", *TINTS):
            action = self._colours.addAction(name.capitalize() or "&As its group")
            action.triggered.connect(partial(self._colour, name))
        self.wire_menu.addAction("&Disconnect").triggered.connect(self._disconnect)
        self._add_dot = self.wire_menu.addAction("&Add Dot")
        self._add_dot.setToolTip("Add a dot here to bend the wire (R, or double-click)")
        self._add_dot.triggered.connect(lambda: add_dot(surface, self._pos))
        self._pos: QPoint | None = None
        self.backdrop_menu.addAction("&Edit Title").triggered.connect(self._edit_title)
        self.backdrop_menu.addAction("&Delete Backdrop").triggered.connect(self.delete_backdrop)
        self.backdrop_menu.addMenu(self._colours)

    def fill(self, node_actions: Sequence[QAction], canvas_actions: Sequence[QAction]) -> None:
        for menu, actions in ((self.node_menu, node_actions), (self.canvas_menu, canvas_actions)):
            menu.clear()
            menu.addActions(list(actions))
        self.node_menu.addMenu(self._colours)

    def delete_backdrop(self, *_: object) -> None:
        session, backdrop = self._surface.session, self._marks.backdrop
        if backdrop is not None:
            self._marks.choose(None, None)
            session.do(remove(session.network, backdrop.index))

    def open(self, event: QContextMenuEvent) -> None:
        """Pop up the menu of what is under the pointer or, by the keyboard, what is selected."""
        if event.reason() == QContextMenuEvent.Reason.Keyboard:
            hit, pos = self._selected()
        else:
            pos = event.pos()
            hit = self._surface.hit(self._surface.view.scene_point(pos))
        self._pos = pos
        menu = self._menu_of(hit)
        if menu.actions():
            menu.popup(self._surface.view.viewport().mapToGlobal(pos))

    def _menu_of(self, hit: Hit) -> QMenu:
        session = self._surface.session
        if hit.node is not None:
            if hit.node.id not in session.selection:
                self._marks.choose(None, None)
                session.select([hit.node.id])
            return self.node_menu
        if hit.wire is not None or hit.backdrop is not None:
            session.select(())
            self._marks.choose(hit.wire.link if hit.wire else None, hit.backdrop, hit.dot)
            self._add_dot.setEnabled(hit.dot is None)
            return self.wire_menu if hit.wire is not None else self.backdrop_menu
        return self.canvas_menu

    def _selected(self) -> tuple[Hit, QPoint]:
        content, view = self._surface.content, self._surface.view
        names = self._surface.session.selection
        link, backdrop = self._marks.link, self._marks.backdrop
        if names:
            item = content.nodes[names[-1]]
            return Hit(node=item), view.pixel(item.frame().center())
        if link is not None:
            wire = content.wires[link]
            dot = self._marks.dot
            middle = wire.line()[len(wire.line()) // 2] if dot is None else wire.dots[dot]
            return Hit(wire=wire, dot=dot), view.pixel(middle)
        if backdrop is not None:
            return Hit(backdrop=backdrop), view.pixel(backdrop.head(view.zoom).center())
        return Hit(), view.viewport().rect().center()

    def _colour(self, name: str, *_: object) -> None:
        session, backdrop = self._surface.session, self._marks.backdrop
        if session.selection:
            value = name or ABSENT
            steps = [set_node_field(node, COLOUR, value) for node in session.selection]
            session.do(together(steps, f"Colour {named(session.selection)}"))
        elif backdrop is not None:
            changed = replace(backdrop.shown, colour=name)
            session.do(change(session.network, backdrop.index, changed))

    def _disconnect(self) -> None:
        link = self._marks.link
        if link is not None:
            self._surface.session.do(rewire(remove=(link,)))

    def _edit_title(self) -> None:
        if self._marks.backdrop is not None:
            self._surface.title_wanted.emit(self._marks.backdrop.index)


def _menu(name: str, parent: QWidget, title: str = "") -> QMenu:
    menu = widgets.labelled(widgets.Menu(title, parent), name)
    menu.setToolTipsVisible(True)
    return menu


# What the keys do on the canvas: nudge, go from node to node, wire, open.

_KEY = Qt.Key
_ARROWS: Mapping[int, tuple[float, float]] = {
    _KEY.Key_Left: (-1.0, 0.0),
    _KEY.Key_Right: (1.0, 0.0),
    _KEY.Key_Up: (0.0, -1.0),
    _KEY.Key_Down: (0.0, 1.0),
}
_NUDGE, _FINE = 12.0, 1.0
_ASIDE = 2.5  # how much worse it is to be off the line than to be far


class Keys:
    """The canvas's keys that are no shortcuts of the window.

    Arrows move what is selected, with Shift by one unit; where nothing is selected, and with Ctrl,
    they go from node to node. Shift with Ctrl adds to the selection.
    """

    def __init__(self, surface: Surface) -> None:
        self._surface, self._marks = surface, surface.marks
        self._nudging = False

    def press(self, event: QKeyEvent) -> bool:
        if event.key() == _KEY.Key_Escape and self._surface.view.mouse.busy:
            self._surface.view.mouse.cancel()
            return True
        arrow = _ARROWS.get(event.key())
        if arrow is not None:
            self._arrow(arrow, event.modifiers())
            return True
        selected = self._surface.session.selection
        if event.key() in (_KEY.Key_Return, _KEY.Key_Enter) and not event.modifiers():
            if selected:
                self._surface.activated.emit(selected[-1])
            elif self._marks.backdrop is not None:
                self._surface.title_wanted.emit(self._marks.backdrop.index)
            return True
        if event.key() == _KEY.Key_Tab:
            self._surface.search_wanted.emit(QPointF(*self._surface.cursor_point()))
            return True
        return False

    def release(self, event: QKeyEvent) -> None:
        if self._nudging and event.key() in _ARROWS and not event.isAutoRepeat():
            self._nudging = False
            self._surface.session.end_gesture()

    def _arrow(self, arrow: tuple[float, float], keys: Qt.KeyboardModifier) -> None:
        selected = self._surface.session.selection
        going = bool(keys & Qt.KeyboardModifier.ControlModifier)
        shift = bool(keys & Qt.KeyboardModifier.ShiftModifier)
        step = _FINE if shift else _NUDGE
        if not (going or selected) and nudge_dot(self._surface, QPointF(*arrow) * step):
            self._nudging = True
        elif going or not (selected or self._marks.backdrop is not None):
            self._go(arrow, adding=shift)
        elif selected:
            self._nudge(QPointF(*arrow) * step)
        elif self._marks.backdrop is not None:
            self._shift_backdrop(self._marks.backdrop, QPointF(*arrow) * _NUDGE, resize=shift)

    def _nudge(self, by: QPointF) -> None:
        session, nodes = self._surface.session, self._surface.content.nodes
        places = {
            name: (nodes[name].x() + by.x(), nodes[name].y() + by.y()) for name in session.selection
        }
        self._nudging = True
        moving = moved_with_dots(session.network, places)
        session.do(moving, gesture=("nudge", session.selection))
        self._surface.view.make_visible(self._surface.content.bounds(session.selection))

    def _shift_backdrop(self, backdrop: BackdropItem, by: QPointF, *, resize: bool) -> None:
        session, content = self._surface.session, self._surface.content
        frame = backdrop.frame()
        gesture = ("backdrop", backdrop.index, resize)
        self._nudging = True
        if resize:
            changed = backdrop_at(backdrop.shown, frame.adjusted(0, 0, by.x(), by.y()))
            session.do(change(session.network, backdrop.index, changed), gesture=gesture)
            return
        names = nodes_on(session.network, backdrop.index, content.sizes())
        places = {name: content.nodes[name].pos() + by for name in names}
        operation = moved_together(session.network, backdrop, frame.translated(by), places)
        session.do(operation, gesture=gesture)

    def _go(self, arrow: tuple[float, float], *, adding: bool) -> None:
        """To the next node or backdrop that way; where nothing is selected, to the middle one."""
        surface, marks = self._surface, self._marks
        session, content = surface.session, surface.content
        spots: dict[str | int, QPointF] = {
            name: item.frame().center() for name, item in content.nodes.items()
        }
        for item in () if adding else content.backdrops:
            spots[item.index] = item.head(surface.view.zoom).center()
        here: str | int = next(iter(session.selection[-1:]), "")
        if not here and marks.backdrop is not None:
            here = marks.backdrop.index
        start = spots.pop(here, None)
        ways = {
            one: spot - (start or surface.view.visible_rect().center())
            for one, spot in spots.items()
        }

        def cost(one: str | int) -> float:
            way = ways[one]
            if start is None:
                return way.manhattanLength()
            ahead = way.x() * arrow[0] + way.y() * arrow[1]
            aside = abs(way.x() * arrow[1]) + abs(way.y() * arrow[0])
            return ahead + _ASIDE * aside if ahead > 1.0 else math.inf

        nearest = min(ways, key=cost, default=None)
        if nearest is None or math.isinf(cost(nearest)):
            return
        if isinstance(nearest, str):
            marks.choose(None, None)
            session.select((*session.selection, nearest) if adding else (nearest,))
            surface.view.make_visible(content.nodes[nearest].frame())
        else:
            session.select(())
            marks.choose(None, content.backdrops[nearest])
            surface.view.make_visible(content.backdrops[nearest].frame())


class Crumbs(QWidget):
    """Buttons for the network and each macro on the way, and one that leads back by one."""

    def __init__(self, level: Level, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        widgets.labelled(self, "crumbs", "path to the open macro")
        self._level = level
        self._row = widgets.filled(QHBoxLayout(self), margins=(4, 2, 4, 2), spacing=2)
        about = "Leave this macro and show the network around it (Alt+PgUp)"
        self.up = self._button("crumbs.up", "↑ Up", about, level.leave)
        self._way = QWidget(self)
        widgets.filled(self._row, self.up, self._way, margins=None)
        self.steps: list[QToolButton] = []
        self._names: tuple[str, ...] = ()
        for signal in (level.opened, level.changed, level.session.state_changed):
            signal.connect(self._fill)
        self.setBackgroundRole(RAISED)
        self.setAutoFillBackground(True)
        self._fill()

    def _fill(self, *_: object) -> None:
        document, path = self._level.session.document, self._level.path
        name = document.network.name or (document.path.stem if document.path else "network")
        self.setVisible(bool(path))
        if (name, *path) == self._names:  # as after most edits
            return
        self._names = (name, *path)
        self._way.hide()
        self._way.deleteLater()
        self._way, self.steps = QWidget(self), []
        row = widgets.filled(QHBoxLayout(self._way), spacing=2)
        for depth, text in enumerate((name, *path)):
            going = partial(self._level.go_to, path[:depth])
            button = self._button(f"crumb.{depth}", text, f"Show the nodes of {text}", going)
            button.setEnabled(depth < len(path))
            arrow = (widgets.plain_label("", self._way, "›", role=FAINT),) if depth else ()
            widgets.filled(row, *arrow, button, margins=None)
            self.steps.append(button)
        widgets.filled(self._row, self._way, margins=None)
        self._way.show()
        self._row.activate()
        self.resize(self.sizeHint())
        self.raise_()

    def _button(self, name: str, text: str, about: str, act: widgets.Act) -> QToolButton:
        button = widgets.tool_button(name, text.replace("&", "&&"), about, self, act)
        button.setAutoRaise(True)
        button.setToolTip(declared_text.tip(about))
        return button


_NARROWEST = 160


class TitleEditor(TypeIn):
    """A field over a backdrop's title; Enter and leaving it take the text, Esc does not."""

    # (index, text): the backdrop of that place in the document's list gets this title
    edited = Signal(int, str)

    def __init__(self, view: GraphView) -> None:
        super().__init__(view.viewport())
        self._view = view
        self._index: int | None = None
        self.hide()
        self.editingFinished.connect(self.finish)
        self.given_up.connect(self.dismiss)

    def edit(self, backdrop: BackdropItem) -> None:
        head, view = backdrop.head(self._view.zoom), self._view
        place = QRect(view.pixel(head.topLeft()), view.pixel(head.bottomRight()))
        line = self.sizeHint().height()
        place.setWidth(max(place.width(), _NARROWEST))
        place.setHeight(line if backdrop.shown.note else max(place.height(), line))
        self.setGeometry(place)
        self._index = backdrop.index
        about = "Text of the note" if backdrop.shown.note else "Title of the backdrop"
        widgets.labelled(self, "canvas.title", about)
        self.show_text(backdrop.title)
        self.setModified(True)  # so that Esc is its own, and no shortcut
        self.selectAll()
        self.show()
        self.raise_()
        self.setFocus(Qt.FocusReason.PopupFocusReason)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        super().keyPressEvent(event)
        event.accept()  # no key is also the canvas's

    def finish(self) -> None:
        index = self._index
        self.dismiss()
        if index is not None:
            self.edited.emit(index, self.text().strip())

    def dismiss(self) -> None:
        self._index = None
        if self.isVisible():
            self.hide()
            self._view.setFocus(Qt.FocusReason.PopupFocusReason)
