"""What viewers have in common: their queries, status line, and lists of the network's ports."""

from collections.abc import Collection, Hashable, Iterable, Sequence
from typing import Any, ClassVar

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtGui import QHideEvent, QShowEvent, QStandardItem, QStandardItemModel
from PySide6.QtWidgets import QComboBox, QHBoxLayout, QSizePolicy, QWidget

from app.editor import declared_text, messages, widgets
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Answer, Query
from app.editor.session import Session
from app.editor.theme import ERROR, TEXT, Theme, theme_of
from core.modules.declaration import Library
from core.network.macro import declared_node
from core.network.network import Network, passed_through
from core.records import replace


class Viewer(QWidget):
    """A widget that shows answers.

    Subclasses return their queries in `queries` and show the answers in `take`; they call `ask`
    when the queries change. The owner is the viewer's name, unique in the window.
    """

    posted = Signal()  # its queries have been posted: it may show something else
    room: ClassVar[tuple[int, int] | None] = None  # letters across and lines it likes to have

    def __init__(
        self, session: Session, evaluator: Evaluator, owner: str, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName(owner)
        self.session = session
        self.evaluator = evaluator
        self.owner = owner
        self._active = False
        self._posted: tuple[Query, ...] = ()
        evaluator.answered.connect(self._answered)
        session.changed.connect(self.follow)
        session.opened.connect(self.follow_opening)

    @property
    def theme(self) -> Theme:
        return theme_of(self)

    def sizeHint(self) -> QSize:
        if self.room is None:
            return super().sizeHint()
        metrics = self.fontMetrics()
        return QSize(self.room[0] * metrics.averageCharWidth(), self.room[1] * metrics.height())

    def queries(self) -> Sequence[Query]:
        return ()

    def accepts(self, query: Query) -> bool:
        """Whether an answer to this is still of use."""
        return query in self._posted

    def take(self, answer: Answer) -> None:
        """Show an answer that `accepts` lets through."""

    def follow(self, before: Any, after: Any) -> None:
        """The document has changed: the networks before and after."""

    def follow_opening(self) -> None:
        """Another document is open."""

    def ask(self) -> None:
        """Post the present queries, if the viewer is visible."""
        if not self._active:
            return
        self._posted = tuple(self.queries())
        self.evaluator.ask(self.owner, self._posted)
        self.posted.emit()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._active = True
        self.ask()

    def hideEvent(self, event: QHideEvent) -> None:
        super().hideEvent(event)
        if self._active:
            self._active = False
            self._posted = ()
            self.evaluator.forget(self.owner)

    def _answered(self, answer: Any) -> None:
        if answer.owner == self.owner and self._active and self.accepts(answer.query):
            self.take(answer)


class StatusLine(QWidget):
    """What is shown or why nothing is, and what is under the cursor, with their descriptions."""

    def __init__(self, owner: str, description: str, more: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.mark = messages.Mark(self)
        self.mark.show_severity("error")
        self.title = widgets.ElidedLabel(f"{owner}.title", description, self)
        self.more = widgets.ElidedLabel(f"{owner}.read", more, self)
        self.away = messages.close_button(f"{owner}.close", self)
        self.away.clicked.connect(lambda: self.show_text(""))
        parts = (self.mark, (self.title, 1), self.away, self.more)
        widgets.filled(QHBoxLayout(self), *parts, margins=(6, 0, 6, 2))
        self.show_text("")

    def show_text(self, text: str, *, failed: bool = False) -> None:
        self.title.show_text(text)
        widgets.set_role(self.title, ERROR if failed else TEXT)
        self.mark.setVisible(failed)
        self.away.setVisible(failed)

    def show_more(self, text: str) -> None:
        self.more.show_text(text)


PICTURE_TYPES = ("image", "magnitude", "phase", "transfer", "pupil")
"""Types of ports that are shown in the viewers of pictures."""

PLOT_TYPES = ("curve", "table")
"""Types of ports that are shown in the viewer of curves."""

VIEWER_NUMBERS = tuple(range(1, 10))
"""Of the viewers of pictures there may be."""


def ports_by_node(
    network: Network, library: Library, types: Collection[str]
) -> dict[str, tuple[str, ...]]:
    """Outputs of these types by node, in order; of a disabled node what it passes on."""
    by_node = {}
    for node in network.nodes.values():
        declared = declared_node(node, library)
        if declared is None:
            continue
        through = passed_through(declared)
        ports = tuple(
            f"{node.id}.{port.name}"
            for port in declared.outputs
            if port.types[0] in types and (port.name in through or not node.disabled)
        )
        if ports:
            by_node[node.id] = ports
    return by_node


def ports_depend_on(network: Network) -> Hashable:
    """What `ports_by_node` depends on: cheap to compare after each change."""
    return tuple(
        (node.id, node.module, node.disabled, node.macro and node.macro.extra.get("outputs"))
        for node in network.nodes.values()
    )


def followed(port: str, before: Network, after: Network) -> str | None:
    """Where the port is after a change: under its node's new name, or None if that is gone."""
    name, _, output = port.rpartition(".")
    if name in after.nodes:
        return port
    come = [new for new in after.nodes if new not in before.nodes]
    old = before.nodes.get(name)
    for new in come:
        now = after.nodes[new]
        if old is not None and replace(old, id=new, noise=now.noise) == now:
            return f"{new}.{output}"
    return None


VALUE = Qt.ItemDataRole.UserRole


class NodeChoice(QComboBox):
    """Entries under the names of nodes, `nothing` first; call `fill` once it is made."""

    def __init__(self, session: Session, nothing: str, parent: QWidget | None) -> None:
        super().__init__(parent)
        self.session = session
        self.value = ""
        """The entry that is chosen; empty for none."""
        self._nothing = nothing
        self._filled: Hashable = None
        self.entries = QStandardItemModel(self)
        self.setModel(self.entries)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMaxVisibleItems(24)
        self.activated.connect(self.take_at)
        session.changed.connect(self._changed)
        session.opened.connect(self.fill)

    def groups(self) -> Iterable[tuple[str, Sequence[QStandardItem]]]:
        """The names of nodes, with the entries below each."""
        raise NotImplementedError

    def take(self, value: str | None) -> None:
        """An entry has been chosen: its value, empty for none; None where it has no value."""
        raise NotImplementedError

    def take_at(self, index: int) -> None:
        self.take(self.itemData(index, VALUE))

    def show_value(self, value: str) -> None:
        self.value = value
        self.setCurrentIndex(max(0, self.findData(value, VALUE)))
        self.setToolTip(value or self._nothing)

    def showPopup(self) -> None:
        bar = self.view().verticalScrollBar().sizeHint().width()
        width = self.view().sizeHintForColumn(0) + bar
        self.view().setMinimumWidth(max(width, self.width()))
        super().showPopup()

    def fill(self) -> None:
        self._filled = ports_depend_on(self.session.network)
        rows = [entry(self._nothing, "")]
        for name, entries in self.groups():
            head = QStandardItem(name)
            head.setFlags(Qt.ItemFlag.NoItemFlags)
            rows += [head, *entries]
        self.entries.clear()
        self.entries.invisibleRootItem().appendRows(rows)  # at once: the box follows each insertion
        self.show_value(self.value)

    def _changed(self, _before: Any, after: Any) -> None:
        if ports_depend_on(after) != self._filled:
            self.fill()


def entry(text: str, value: str, tooltip: str = "") -> QStandardItem:
    item = QStandardItem(text)
    item.setData(value, VALUE)
    if tooltip:
        item.setToolTip(tooltip)
    return item


class PortChoice(NodeChoice):
    """Every output of the network that can be shown, by node."""

    chosen = Signal(str)  # port: the person has chosen a port; an empty text is none

    def __init__(
        self, session: Session, types: tuple[str, ...], nothing: str, parent: QWidget | None = None
    ) -> None:
        super().__init__(session, nothing, parent)
        self._types = types
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setMinimumContentsLength(3)
        self.fill()

    @property
    def port(self) -> str:
        return self.value

    def choose(self, port: str | None) -> None:
        self.show_value(port or "")

    def groups(self) -> Iterable[tuple[str, Sequence[QStandardItem]]]:
        by_node = ports_by_node(self.session.network, self.session.library, self._types)
        for node, ports in by_node.items():
            declared = self.session.declared(node)
            title = declared_text.titled(node, declared.title) if declared is not None else node
            yield title, [entry(port, port) for port in ports]

    def take(self, value: str | None) -> None:
        if value is not None:
            self.value = value
            self.chosen.emit(value)
