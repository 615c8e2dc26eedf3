"""The head of a panel: title, name of the node, and what can be done with all of it."""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, QRect, Qt, QTimer, Signal
from PySide6.QtGui import QGuiApplication, QPainter, QPaintEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from app.editor import widgets
from app.editor.declared_text import flowing, says_more, tip
from app.editor.evaluation.queries import Badge
from app.editor.panels.fields.type_in import TypeIn
from app.editor.panels.preview_view import PreviewView
from app.editor.theme import ERROR, FAINT, set_ground, set_ink, theme_of
from core.network.network import Node

_SHARE = 0.45  # of the panels' height, for an illustration at most
_LEAST_LINES = 6  # that it is high at least
_LINES = 7  # of what is wrong with the node
_WIDEST = 10_000
_WRAPPED = Qt.TextFlag.TextWordWrap | Qt.AlignmentFlag.AlignTop
_FITTED = (QEvent.Type.LayoutRequest, QEvent.Type.Resize)
_CLICK_MS = 250  # after which it is seen again whether a button is still down


class Problem(widgets.ElidedLabel):
    """What is wrong with the node, in up to seven lines; the tooltip has all of it."""

    def lines(self, width: int) -> tuple[str, int]:
        """The text, cut where it needs more lines than there are, and its height."""
        words, text = self._line.split(" "), self._line
        room, most = QRect(0, 0, width, _WIDEST), _LINES * self.fontMetrics().lineSpacing()
        while True:
            height = self.fontMetrics().boundingRect(room, _WRAPPED, text).height()
            if height <= most or len(words) == 1:
                return text, min(height, most)
            words.pop()
            text = " ".join(words) + " …"

    def paintEvent(self, _event: QPaintEvent) -> None:
        with QPainter(self) as painter:
            painter.setPen(self.palette().color(self.foregroundRole()))
            painter.drawText(self.rect(), _WRAPPED, self.lines(self.width())[0])


class TitleBar(QWidget):
    folded = Signal(bool)  # on: whether all below is to be hidden

    def __init__(self, title: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.row = widgets.filled(QHBoxLayout(self), margins=(4, 3, 4, 3), spacing=2)
        self.fold = self.add_button(
            "fold", "", "fold the panel", "Hide or show the contents of this panel"
        )
        self.fold.setCheckable(True)
        self.fold.setArrowType(Qt.ArrowType.DownArrow)
        self.fold.toggled.connect(self._fold)
        self.title = widgets.ElidedLabel("title", "Title of this panel", self)
        self.title.show_text(title)
        widgets.make_bold(self.title)
        widgets.filled(self.row, self.title, None, margins=None)
        self.setContextMenuPolicy(Qt.ContextMenuPolicy.ActionsContextMenu)

    def add_button(
        self, name: str, text: str, about: str, tooltip: str = "", *, checkable: bool = False
    ) -> QToolButton:
        button = (widgets.toggle_button if checkable else widgets.tool_button)(
            name, text, about, self
        )
        button.setAutoRaise(True)
        button.setToolTip(tip(tooltip or about))
        self.row.addWidget(button)
        return button

    def _fold(self, on: bool) -> None:
        self.fold.setArrowType(Qt.ArrowType.RightArrow if on else Qt.ArrowType.DownArrow)
        self.folded.emit(on)


class PanelHead(QWidget):
    """Title, name, toggles, help and what is wrong; of a module, its group, and what it does.

    An illustration has a place of its own, in which also stands what is wrong: whatever is written
    there moves nothing below. While it is folded away, the place is one line high, and more once
    what is wrong took more; it does not grow while a mouse button is down.
    """

    _badge: Badge | None = None
    _illustration: PreviewView | None = None
    _room = 0, 0  # width of the place, and height that what is wrong has taken in it
    _most = 0  # dots that the illustration may be high

    def __init__(self, title: str, group: str, text: str, parent: QWidget) -> None:
        super().__init__(parent)
        self._module, self._group = title, group
        self._released = QTimer(self, singleShot=True, interval=_CLICK_MS)
        self._released.timeout.connect(self._fit)
        self.bar = bar = TitleBar(title, self)
        self.name = widgets.labelled(TypeIn(bar, characters=10), "node_name", "name of the node")
        self.name.setToolTip(tip("Name of the node in this network"))
        bar.row.insertWidget(1, self.name, 3)
        self.pin = bar.add_button(
            "pin", "Pin", "Keep this panel open when another node is selected", checkable=True
        )
        about = "Save these parameters under a name, or load saved parameters"
        self.sets = bar.add_button("sets", "≡", about)
        self.help = bar.add_button("help", "?", "What this module does", checkable=True)
        self.help.setVisible(bool(text))
        self.close_button = bar.add_button("close", "×", "Close this panel")
        self.text = widgets.plain_label("module_text", self, flowing(text), role=FAINT)
        self.text.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.more = QLabel('<a href="handbook">More in the handbook</a>', self)
        widgets.labelled(self.more, "module_more", "More in the handbook")
        self.more.setTextInteractionFlags(Qt.TextInteractionFlag.TextBrowserInteraction)
        for part in (self.text, self.more):
            part.hide()
            self.help.toggled.connect(part.setVisible)
        self.below = below = QWidget(self)
        self.name_problem = widgets.plain_label("name_problem", below, role=ERROR)
        self.name_problem.hide()
        about = (
            "Auto-Generate: compute after each change; if unticked, the node keeps its result "
            "until you choose Generate Image"
        )
        self.auto = self._act(widgets.toggle_button, "Auto", "Auto-Generate", about)
        about = "Generate Image: compute everything now, including nodes that are not updated"
        self.generate = self._act(widgets.tool_button, "Generate", "Generate Image", about)
        self.disable = self._act(
            widgets.toggle_button, "Disable", "Disable", "Pass the input through unchanged"
        )
        about = "Make this node's picture the output of the network (O)"
        self.output = self._act(widgets.toggle_button, "Output", "Output", about)
        about = "Hide or show the illustration on all panels of this module"
        self.fold_picture = self._act(widgets.tool_button, "", "fold the illustration", about)
        self.fold_picture.setObjectName("fold_illustration")
        self.fold_picture.setCheckable(True)
        self.fold_picture.setAutoRaise(True)
        self.fold_picture.hide()
        acts = (self.auto, self.generate, self.disable, self.output, self.fold_picture)
        buttons = widgets.filled(widgets.FlowLayout(across=4), *acts, margins=None)
        self.place = QWidget(below)
        self.problem = Problem("problem", "Problem with the node", self.place)
        self.problem.hide()
        self.place.installEventFilter(self)
        self._stack = widgets.filled(QVBoxLayout(self.place), self.problem, spacing=2)
        parts = (self.text, self.more, self.name_problem, buttons, self.place)
        widgets.filled(QVBoxLayout(below), *parts, margins=(8, 2, 8, 0), spacing=4)
        widgets.filled(QVBoxLayout(self), bar, below, spacing=2)
        self._fit()
        self._colour()

    def _act(
        self, made: Callable[..., QToolButton], text: str, name: str, about: str
    ) -> QToolButton:
        button = made(text.lower(), text, name, self.below)
        button.setToolTip(tip(about))
        return button

    def illustrate(self, view: PreviewView, *, shown: bool) -> None:
        self._illustration = view
        self._stack.addWidget(view, 1)
        self.fold_picture.show()
        self.show_illustration(shown)

    def show_illustration(self, on: bool) -> None:
        self.fold_picture.setChecked(not on)
        self.fold_picture.setArrowType(Qt.ArrowType.DownArrow if on else Qt.ArrowType.RightArrow)
        if self._illustration is not None:
            self._illustration.setVisible(on)
        self._fit()

    def fit(self, height: int) -> None:
        """Leave room for the parameters where the panels are so high."""
        self._most = round(_SHARE * height)
        self._fit()

    def _fit(self) -> None:
        line, view = self.fontMetrics().height(), self._illustration
        if self.isVisible() and QGuiApplication.mouseButtons():
            self._released.start()  # nothing moves under the mouse
        else:
            room = self.place.width(), max(line, self.problem.lines(self.place.width())[1])
            self._room = max(room, self._room) if room[0] == self._room[0] else room
            self.problem.setFixedHeight(self._room[1])
        height = self._room[1]
        if view is not None and not view.isHidden():
            most = max(self._most, _LEAST_LINES * line)
            height = max(height, view.height_within(most))
        self.place.setFixedHeight(height)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Follow an illustration that shows more than the last one, and the width."""
        if watched is self.place and event.type() in _FITTED:
            self._fit()
        return False

    def follow(self, node: Node) -> None:
        self.bar.title.show_text(self._module if says_more(self._module, node.id) else "")
        self.show_name_error("")
        self.auto.setChecked(node.auto is not False)
        self.disable.setChecked(node.disabled)
        self.pin.setChecked(node.extra.get("pinned") is True)

    def show_name_error(self, text: str) -> None:
        widgets.show_or_hide(self.name_problem, text)
        if text:
            self.name.mark()

    def set_badge(self, badge: Badge | None) -> None:
        if badge is not None and badge.kind == "running":
            return
        self._badge = badge
        text = badge.text if badge is not None else ""
        self.problem.show_text(text.replace("\n", " · "), tip(text) if text else "")
        self.problem.setVisible(bool(text))
        self._fit()
        self._colour()

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() == QEvent.Type.PaletteChange and hasattr(self, "problem"):
            self._colour()

    def _colour(self) -> None:
        theme = theme_of(self)
        set_ground(self.bar, theme.groups.get(self._group, theme.raised))
        if self._badge is not None:
            set_ink(self.problem, theme.badges[self._badge.kind])
