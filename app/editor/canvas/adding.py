"""The lists that add nodes and wires: search, what fits a loose wire, wiring by the keyboard."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from functools import partial
from operator import itemgetter
from typing import Any

from PySide6 import QtWidgets
from PySide6.QtCore import QEvent, QObject, QPoint, QPointF, QRect, QSize, Qt, Signal
from PySide6.QtGui import QColor, QFocusEvent, QKeyEvent, QKeySequence, QPainter, QPalette

from app.editor.canvas.canvas_style import face_of, geometry_of
from app.editor.canvas.node_item import NodePort
from app.editor.canvas.placing import Surface, added, free_place, show_new, two_places
from app.editor.library_view import found_by
from app.editor.messages import told
from app.editor.theme import FAINT
from app.editor.widgets import RIGHT, filled, labelled, search_field
from core.editing import wiring
from core.editing.layout import Point
from core.editing.operations import Operation, rewire, together
from core.modules.declaration import Library, Port, declaration, local_key
from core.network.macro import declared_node
from core.network.network import Link, Network, Node
from core.records import dataclass, replace

_ROLE = Qt.ItemDataRole.UserRole
_ROWS = 9
_NARROW, _WIDE = 44, 76  # letters
_PADDING = 7


@dataclass(frozen=True)
class Choice:
    """An entry of the list: what is shown, and what is chosen by it.

    `detail` stands beside it, fainter; `words` it is also searched by, and `further` ones only if
    no choice matches without them; `colour` is that of the mark before it. A `remote` one is only
    offered if no other has the words.
    """

    text: str
    value: Any
    detail: str = ""
    words: str = ""
    further: str = ""
    colour: str = ""
    tip: str = ""
    remote: bool = False


def matching(choices: Sequence[Choice], typed: str) -> list[Choice]:
    """Choices with every word, first those that begin so; else remote ones, or by further words."""
    words = typed.casefold().split()

    def fits(choice: Choice, further: str = "") -> bool:
        text = f"{choice.text} {choice.detail} {choice.words} {further}".casefold()
        return all(word in text for word in words)

    def rank(choice: Choice) -> int:
        text, word = choice.text.casefold(), words[0]
        begins = text.startswith(word), any(part.startswith(word) for part in text.split())
        return next((n for n, met in enumerate((*begins, word in text)) if met), 3)

    near, remote = ([one for one in choices if one.remote == far] for far in (False, True))
    if not words:
        return near
    for group in (near, remote):
        if matches := [choice for choice in group if fits(choice)]:
            return sorted(matches, key=rank)
    return [choice for choice in near if fits(choice, choice.further)]


class ChoicePopup(QtWidgets.QFrame):
    chosen = Signal(object)  # (value): an entry was chosen; the popup has closed
    abandoned = Signal()  # it was closed by Esc, or because the focus went elsewhere

    passed_on = QKeySequence("Ctrl+Q")
    """Keys that mean what they mean everywhere: whatever is searched, one can quit."""

    def __init__(self, parent: QtWidgets.QWidget) -> None:
        super().__init__(parent, objectName="canvas.popup", autoFillBackground=True)
        self._ground = parent
        self.setFrameShape(QtWidgets.QFrame.Shape.StyledPanel)
        self.setBackgroundRole(QPalette.ColorRole.Window)  # a view's children take its own
        self.title = labelled(QtWidgets.QLabel(), "canvas.popup.title")
        self.field = search_field("canvas.popup.field", "", "Type to search")
        self.list = labelled(QtWidgets.QListWidget(uniformItemSizes=True), "canvas.popup.list")
        self.list.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        # A click beside the field would otherwise give the focus to what lies below.
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setFocusProxy(self.field)
        self.list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.list.setItemDelegate(_Row(self.list))
        parts, margins = (self.title, self.field, self.list), (_PADDING,) * 4
        self._layout = filled(QtWidgets.QVBoxLayout(self), *parts, margins=margins, spacing=4)
        self._choices: tuple[Choice, ...] = ()
        self.is_open = False
        self.field.textChanged.connect(self._filter)
        self.field.installEventFilter(self)
        self.list.itemClicked.connect(self._choose_item)
        self.hide()

    def open_at(self, pos: QPoint, title: str, choices: Sequence[Choice]) -> None:
        """Show the choices near a point of the parent; another list that is open is abandoned."""
        self.abandon()
        self._choices = tuple(choices)
        self.is_open = True
        self.title.setText(title)
        self.field.setAccessibleName(title)
        self.list.setAccessibleName(title)
        self.field.clear()
        self._filter("")
        self.setGeometry(self._place(pos))
        self.show()
        self.raise_()
        self.field.setFocus(Qt.FocusReason.PopupFocusReason)

    def abandon(self) -> None:
        if self.dismiss():
            self.abandoned.emit()

    def choose(self) -> None:
        item = self.list.currentItem()
        if item is not None:
            self._choose_item(item)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if watched is self.field and self.is_open:
            if isinstance(event, QKeyEvent) and event.type() in _KEYS:
                if event.type() == QEvent.Type.ShortcutOverride:
                    if QKeySequence(event.keyCombination()) == self.passed_on:
                        return False
                    event.accept()  # the window's other shortcuts do not reach in here
                    return True
                return self._key(event)
            if isinstance(event, QFocusEvent) and event.type() == QEvent.Type.FocusOut:
                left = event.reason()
                if left not in (_WINDOW_LEFT, Qt.FocusReason.PopupFocusReason):
                    self.abandon()
        return bool(super().eventFilter(watched, event))

    def _key(self, event: QKeyEvent) -> bool:
        key = Qt.Key(event.key())
        if key == Qt.Key.Key_Escape:
            self.abandon()
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.choose()
        elif key in _STEPS:
            row = self.list.currentRow() + _STEPS[key]
            self.list.setCurrentRow(min(max(row, 0), self.list.count() - 1))
        else:
            return False
        return True

    def _filter(self, typed: str) -> None:
        self.list.clear()
        for choice in matching(self._choices, typed):
            item = QtWidgets.QListWidgetItem(choice.text)
            item.setData(_ROLE, choice)
            item.setToolTip(choice.tip)
            if choice.colour:
                item.setData(Qt.ItemDataRole.DecorationRole, QColor(choice.colour))
            self.list.addItem(item)
        self.list.setCurrentRow(0)

    def _choose_item(self, item: QtWidgets.QListWidgetItem) -> None:
        choice = item.data(_ROLE)
        if self.dismiss():
            self.chosen.emit(choice.value)

    def dismiss(self) -> bool:
        """Close without a signal; whether it was open."""
        was, self.is_open = self.is_open, False
        if was:
            held = self.field.hasFocus()
            self._choices = ()
            self.hide()
            if held:
                self._ground.setFocus(Qt.FocusReason.PopupFocusReason)
        return was

    def _place(self, pos: QPoint) -> QRect:
        room = self._ground.rect().adjusted(4, 4, -4, -4)
        row = max(self.list.sizeHintForRow(0), 1)
        others = self._layout.totalSizeHint().height() - self.list.height()
        spare = room.height() - others - 2 * self.list.frameWidth()
        rows = max(min(len(self._choices), _ROWS, spare // row), 1)
        self.list.setFixedHeight(rows * row + 2 * self.list.frameWidth())
        self._layout.activate()
        letters = [len(choice.text) + len(choice.detail) + 8 for choice in self._choices]
        wide = min(max([_NARROW, *letters]), _WIDE) * self.fontMetrics().averageCharWidth()
        size = QSize(wide + 2 * _PADDING, self._layout.totalSizeHint().height())
        place = QRect(pos, size.boundedTo(room.size()))
        place.moveRight(min(place.right(), room.right()))
        place.moveBottom(min(place.bottom(), room.bottom()))
        return place


class _Row(QtWidgets.QStyledItemDelegate):
    """An entry with its detail at the right, if there is room."""

    def paint(self, painter: QPainter, option: QtWidgets.QStyleOptionViewItem, index: Any) -> None:
        super().paint(painter, option, index)
        choice: Choice = index.data(_ROLE)
        room = option.rect.adjusted(0, 0, -6, 0)
        wide = option.fontMetrics.horizontalAdvance(f"MMM{choice.text}{choice.detail}")
        if wide < room.width():
            chosen = option.state & QtWidgets.QStyle.StateFlag.State_Selected
            role = QPalette.ColorRole.HighlightedText if chosen else FAINT
            painter.setPen(option.palette.color(role))
            painter.drawText(room, RIGHT, choice.detail)


_WINDOW_LEFT = Qt.FocusReason.ActiveWindowFocusReason
_KEYS = (QEvent.Type.KeyPress, QEvent.Type.ShortcutOverride)
_STEPS = {
    Qt.Key.Key_Down: 1,
    Qt.Key.Key_Tab: 1,
    Qt.Key.Key_Up: -1,
    Qt.Key.Key_Backtab: -1,
    Qt.Key.Key_PageDown: _ROWS,
    Qt.Key.Key_PageUp: -_ROWS,
}


class Adding:
    def __init__(self, surface: Surface, popup: ChoicePopup) -> None:
        self._surface = surface
        self._popup = popup
        self._loose: Link | None = None
        popup.chosen.connect(self._chosen)
        popup.abandoned.connect(lambda: self._chosen(self._disconnect_loose))

    def dismiss(self) -> None:
        self._popup.dismiss()
        self._forget_wire()

    def search(self, at: Point) -> None:
        library = self._surface.session.library
        choices = [self._module_choice(key, partial(self.add, key, at)) for key in library]
        pixel = self._surface.view.pixel(QPointF(*at))
        self._popup.open_at(pixel, "Add a module", choices)

    def find_node(self) -> None:
        session, view = self._surface.session, self._surface.view
        choices = []
        for name, item in self._surface.content.nodes.items():
            colour = self._group_colour(item.face.group)
            module = f"{item.face.module} {session.network.nodes[name].module}"
            show, face = partial(self._show_node, name), item.face
            choices.append(Choice(name, show, face.module, module, face.summary, colour))
        if not choices:
            session.message.emit("note", "the network has no nodes to find yet")
            return
        room = view.viewport().rect()
        self._popup.open_at(QPoint(room.width() // 3, room.height() // 8), "Find a node", choices)

    def _show_node(self, name: str) -> None:
        surface, view = self._surface, self._surface.view
        if name in surface.content.nodes:
            surface.session.select([name])
            frame, seen = surface.content.nodes[name].frame(), view.visible_rect()
            fits = frame.width() < seen.width() and frame.height() < seen.height()
            (view.make_visible if fits else view.frame)(frame)

    def ask_for_wire(self, port: NodePort, loose: Link | None, pos: QPoint) -> None:
        """List the modules that fit a wire from a port that ended on empty ground.

        `loose` is the link the wire was before; it is taken away unless something takes its place.
        """
        surface = self._surface
        end: wiring.End = (port.node.id, port.name, port.side)
        other: wiring.Side = "input" if port.side == "output" else "output"
        point = surface.view.scene_point(pos)
        choices = [
            self._module_choice(
                candidate.module,
                partial(self._wire_to, end, candidate, point, loose),
                port=candidate.port,
            )
            for candidate in wiring.fitting(surface.session.library, port.types, other)
        ]
        if other == "input":
            choices += [
                self._remote_choice(end, bridge, point, loose)
                for bridge in wiring.bridged(surface.session.library, port.types)
            ]
        if loose is not None:
            choices.insert(0, Choice(f"Disconnect {loose}", self._disconnect_loose))
        elif not choices:
            kinds = " or ".join(port.types) or "a wire of unknown type"
            surface.session.message.emit("note", f"no module has an {other} for {kinds}")
            return
        start, finish = port.centre(), point
        if port.side == "input":
            start, finish = finish, start
        title = f"Wire {end[0]}.{end[1]} {'to' if other == 'input' else 'from'}"
        self._popup.open_at(pos, title, choices)
        self._loose = loose
        surface.live.show_wire(start, finish, surface.content.style.port(port.types))
        if loose is not None and loose in surface.content.wires:
            surface.content.wires[loose].setVisible(False)

    def connect_selected(self) -> None:
        surface = self._surface
        session = surface.session
        if not session.selection:
            session.message.emit("note", "first select the node that you want to wire")
            return
        possible = possible_links(session.network, session.library, session.selection)
        choices = [
            Choice(str(link), partial(session.do, rewire(add=(link,))), remark)
            for link, remark in possible.items()
        ]
        choices += [
            Choice(f"Disconnect {link}", partial(session.do, rewire(remove=(link,))))
            for link in session.network.links
            if {link.source, link.target} & set(session.selection)
        ]
        if not choices:
            session.message.emit("note", "there is nothing to wire the selected nodes to")
            return
        item = surface.content.nodes[session.selection[-1]]
        title = f"Wire {', '.join(session.selection[:3])}{' …' * (len(session.selection) > 3)}"
        surface.view.make_visible(item.frame())
        self._popup.open_at(surface.view.pixel(item.frame().bottomLeft()), title, choices)

    def _group_colour(self, group: str) -> str:
        theme = self._surface.content.style.theme
        return theme.groups.get(group, theme.line)

    def _module_choice(self, key: str, value: Callable[[], None], port: str = "") -> Choice:
        known = declaration(self._surface.session.library[key])
        _, summary, further = found_by(known)
        return Choice(
            text=known.title,
            value=value,
            detail=port or known.group,
            words=f"{key} {known.group} {known.explained}",
            further=f"{summary} {further}",
            colour=self._group_colour(known.group),
            tip=known.summary,
        )

    def _remote_choice(
        self, end: wiring.End, bridge: wiring.Bridge, point: QPointF, loose: Link | None
    ) -> Choice:
        transform, _, candidate = bridge
        title = declaration(self._surface.session.library[transform.module]).title
        leading = partial(self._wire_behind, end, bridge, point, loose)
        choice = self._module_choice(candidate.module, leading, port=f"after {title}")
        about = (
            f"The module's input is of type {candidate.port}: {title} is inserted first.\n"
            f"{choice.tip}"
        )
        return replace(choice, tip=about, remote=True)

    def add(self, key: str, at: Point) -> None:
        """Add a node at a point of the scene; with a node selected, wired on to that one."""
        session = self._surface.session
        name, operation = added(self._surface, key, at)
        if session.do(operation):
            show_new(self._surface, name)

    def _wire_to(
        self, end: wiring.End, candidate: wiring.Candidate, point: QPointF, loose: Link | None
    ) -> None:
        at = self._place(end, candidate, point)
        self._wire(loose, partial(wiring.wired_to, end=end, candidate=candidate, at=at))

    def _wire_behind(
        self, end: wiring.End, bridge: wiring.Bridge, point: QPointF, loose: Link | None
    ) -> None:
        places = two_places(self._surface, bridge, self._place(end, bridge[0], point))
        self._wire(loose, partial(wiring.wired_behind, end=end, bridge=bridge, places=places))

    def _place(self, end: wiring.End, candidate: wiring.Candidate, point: QPointF) -> Point:
        """Where a new node's port is at the end of the wire that was drawn."""
        surface = self._surface
        node = Node(local_key(candidate.module), candidate.module)
        face = face_of(node, declaration(surface.session.library[candidate.module]), ())
        side: wiring.Side = "input" if end[2] == "output" else "output"
        corner = point - geometry_of(face, surface.content.style).ports[side, candidate.port]
        return free_place(surface, candidate.module, (corner.x(), corner.y()))

    def _wire(
        self, loose: Link | None, leading: Callable[[Network, Library], tuple[str, Operation]]
    ) -> None:
        surface, session = self._surface, self._surface.session
        removing = rewire(remove=(loose,) if loose is not None else ())
        with told(session.message.emit):
            name, operation = leading(removing.apply(session.network), session.library)
            if session.do(together((removing, operation), operation.text)):
                show_new(surface, name)

    def _disconnect_loose(self) -> None:
        if self._loose is not None:
            self._surface.session.do(rewire(remove=(self._loose,)))

    def _chosen(self, value: Any) -> None:
        value()
        self._forget_wire()

    def _forget_wire(self) -> None:
        link, self._loose = self._loose, None
        self._surface.live.setVisible(False)
        if link is not None and link in self._surface.content.wires:
            self._surface.content.wires[link].setVisible(True)


# Which wires some nodes could have, for the list that wires by the keyboard. Without Qt.


def possible_links(network: Network, library: Library, names: Collection[str]) -> dict[Link, str]:
    """Every link that fits, and what it would replace; first those into inputs that need one."""
    among = names if len(names) > 1 else network.nodes
    ours = set(names)
    possible = [
        found
        for source in among
        for target in among
        if source != target and ours & {source, target}
        for found in _between(network, library, source, target)
    ]
    return {link: remark for _, link, remark in sorted(possible, key=itemgetter(0))}


def _between(
    network: Network, library: Library, source: str, target: str
) -> Iterator[tuple[int, Link, str]]:
    taken = {link.input: link for link in network.links_into(target)}
    for output in _ports(network, library, source, "output"):
        for entry in _ports(network, library, target, "input"):
            link = Link(source, output.name, target, entry.name)
            old = taken.get(entry.name)
            if old == link or not set(output.types) & set(entry.types):
                continue
            if wiring.refusal(network, library, link) is None:
                remark = f"instead of {old.source}.{old.output}" if old is not None else ""
                yield 2 if old is not None else 0 if entry.required else 1, link, remark


def _ports(network: Network, library: Library, name: str, side: str) -> tuple[Port, ...]:
    known = declared_node(network.nodes[name], library)
    if known is None:
        return ()
    return known.inputs if side == "input" else known.outputs
