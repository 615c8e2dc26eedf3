"""Which node's region a viewer shows, and how it is edited there."""

from __future__ import annotations

from typing import Any

from PySide6.QtCore import QObject, QPoint, Signal
from PySide6.QtWidgets import QToolButton

from app.editor.evaluation.evaluator import Evaluator
from app.editor.session import Session
from app.editor.viewers.picture.picture_canvas import PictureCanvas
from app.editor.viewers.picture.region_overlay import Region, Size
from app.editor.viewers.pixels.picture_query import Picture
from app.editor.widgets import Menu, labelled
from core.chain.wires import Image
from core.editing.operations import ABSENT, Operation, Together, set_parameter
from core.errors import ImagechainError, ParameterError
from core.modules.declaration import Declaration
from core.names import thaw
from core.network.network import Network, Node

PARAMETERS = ("region_x", "region_y", "region_width", "region_height")


class RegionTool(QObject):
    """Shows the region of the node selected last, or of a pinned one, on a picture of it."""

    picture_wanted = Signal(str)  # port: the viewer is to show that picture

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator | None,
        canvas: PictureCanvas,
        button: QToolButton,
    ) -> None:
        super().__init__(canvas)
        self._session = session
        self._evaluator = evaluator
        self._canvas = canvas
        self._overlay = canvas.region
        self._button = button
        self._picture: Picture | None = None
        self._port: str | None = None
        self._node: str | None = None
        self._gesture: object | None = None
        self._modules: list[tuple[str, str, Network | None]] | None = None
        self._having: tuple[str, ...] = ()
        self._restoring: tuple[str, Operation] | None = None
        for signal in (session.changed, session.selection_changed, session.opened):
            signal.connect(self.follow)
        if evaluator is not None:
            evaluator.pass_done.connect(self.follow)
        overlay = self._overlay
        overlay.began.connect(self._begin)
        overlay.changed.connect(self._change)
        overlay.ended.connect(self._end)
        overlay.draw_wanted.connect(self.draw)
        overlay.armed_changed.connect(self._armed)
        overlay.menu_wanted.connect(self._open_menu)
        button.clicked.connect(self._clicked)
        self.follow()

    def show_picture(self, picture: Picture | None, port: str | None) -> None:
        self._picture, self._port = picture, port
        self.follow()

    def follow(self, *_: object) -> None:
        self._button.setEnabled(bool(self._all()))
        self._node = next((name for name in self._chosen() if self._lies_on(name)), None)
        size = self._size(self._node)
        if self._node is None or size is None or self._picture is None:
            self._overlay.clear()
            self._describe("")
            if not self._chosen():
                self._overlay.arm(False)
            return
        declared = self._session.declared(self._node)
        assert declared is not None
        region, fits = region_of(declared, self._session.valued(self._node), size)
        self._overlay.frame(region, fits, size, self._picture.facts.extent, self._node)
        self._describe(f"region of {self._node}: {region.description()}")

    def draw(self) -> None:
        """Draw a region: of this picture's node, the selected one, or the first that has one."""
        if self._node is None:
            name = self._meant()
            if name is None:
                self._session.message.emit("note", "no module of this network has a region to draw")
                self._overlay.arm(False)
                return
            if name not in self._chosen():
                self._session.select([name])
            if self._node is None and (source := self._source(name)) is not None:
                self.picture_wanted.emit(source)
            elif self._node is None:
                self._session.message.emit("note", f"{name} has no picture yet to draw a region on")
                self._overlay.arm(False)
                return
        self._overlay.arm(True)
        self._overlay.hold(True)
        self._canvas.setFocus()

    def _armed(self, on: bool) -> None:
        self._button.setChecked(on)
        if on and self._node is not None:
            text = f"Drag a rectangle for {self._node}; Esc cancels"
            self._session.message.emit("note", text)
        elif self._node is not None:
            text = (
                "Arrow keys move the region; Ctrl moves its last corner; Shift moves ten "
                "times as far"
            )
            self._session.message.emit("note", text)

    def _clicked(self) -> None:
        if self._button.isChecked():
            self.draw()
            self._button.setChecked(self._overlay.armed)
        else:
            self._overlay.arm(False)

    def _all(self) -> tuple[str, ...]:
        """Nodes that have a region; of a slider's drag, with each picture, they stay the same."""
        session = self._session
        modules = [(name, node.module, node.macro) for name, node in session.network.nodes.items()]
        if modules != self._modules:
            self._modules = modules
            self._having = tuple(name for name, *_ in modules if has_region(session.declared(name)))
        return self._having

    def _chosen(self) -> list[str]:
        nodes, having = self._session.network.nodes, set(self._all())
        pinned = (name for name in nodes if nodes[name].extra.get("pinned") is True)
        names = dict.fromkeys((*self._session.selection[-1:], *pinned))
        return [name for name in names if name in having]

    def _meant(self) -> str | None:
        names = [*self._chosen(), *self._all()]
        on_this = (name for name in names if self._lies_on(name))
        first = self._chosen()[:1] or [*on_this, *names][:1]
        return first[0] if first else None

    def _lies_on(self, name: str) -> bool:
        picture, source = self._picture, self._source(name)
        if picture is None or picture.facts.kind != "picture" or source is None:
            return False
        if self._port == source:
            return True
        of = (self._port or "").rpartition(".")[0]
        before = of == name or of in self._before(name)
        return before and self._shape(self._port) == self._shape(source) is not None

    def _source(self, name: str) -> str | None:
        declared = self._session.declared(name)
        for link in self._session.network.links_into(name):
            port = declared.input(link.input) if declared is not None else None
            if port is not None and "image" in port.types:
                return f"{link.source}.{link.output}"
        return None

    def _before(self, name: str) -> set[str]:
        network = self._session.network
        upstream: set[str] = set()
        rest = [name]
        while rest:
            into = {link.source for link in network.links_into(rest.pop())} - upstream
            upstream |= into
            rest += into
        return upstream

    def _size(self, name: str | None) -> tuple[int, int] | None:
        shape = self._shape(self._source(name)) if name is not None else None
        return None if shape is None else (shape[1], shape[0])

    def _shape(self, port: str | None) -> tuple[int, int] | None:
        plan = self._evaluator.plan if self._evaluator is not None else None
        if plan is None or port is None:
            return None
        try:
            value: Any = plan.output(port)
        except ImagechainError:
            return None
        return (value.rows, value.columns) if isinstance(value, Image) else None

    def _describe(self, text: str) -> None:
        if text != self._canvas.accessibleDescription():
            self._canvas.setAccessibleDescription(text)

    def _begin(self) -> None:
        node = self._session.network.nodes.get(self._node or "")
        if node is not None and not self._is_linked(node.id):
            self._gesture, self._restoring = object(), (node.id, as_it_was(node))

    def _is_linked(self, node: str) -> bool:
        """Whether the region follows other parameters; says so."""
        why = self._session.follows(node, PARAMETERS)
        if why:
            self._session.message.emit("error", why)
        return bool(why)

    def _change(self, region: Any) -> None:
        if self._node is not None and self._gesture is not None:
            self._session.do(setting(self._node, region), gesture=self._gesture)

    def _end(self, accepted: bool) -> None:
        gesture, restoring = self._gesture, self._restoring
        self._gesture = self._restoring = None
        if gesture is None:
            return
        if not accepted and restoring is not None and restoring[0] in self._session.network.nodes:
            self._session.do(restoring[1], gesture=gesture)
        self._session.end_gesture()

    def _open_menu(self, at: QPoint) -> None:
        menu = labelled(Menu(self._canvas), "region.menu")
        all_of_it = menu.addAction("&Whole Picture")
        all_of_it.setObjectName("region.whole")
        all_of_it.triggered.connect(self._take_whole)
        menu.addAction("&Draw Region (R)").triggered.connect(self.draw)
        menu.aboutToHide.connect(menu.deleteLater)
        menu.popup(at)

    def _take_whole(self) -> None:
        if self._node is not None and not self._is_linked(self._node):
            self._session.do(whole(self._node))


# A region in the document: read, and set.


def has_region(declared: Declaration | None) -> bool:
    return declared is not None and all(declared.parameter(name) for name in PARAMETERS)


def region_of(declared: Declaration, node: Node, size: Size) -> tuple[Region, bool]:
    """The region as it lies in a picture of that size, and whether the document's fits there."""
    x, y, width, height = (_value(declared, node, name) for name in PARAMETERS)
    left, across, fits_x = _within(x, width, size[0])
    top, along, fits_y = _within(y, height, size[1])
    return Region(left, top, across, along), fits_x and fits_y


def _within(first: int, length: int, whole: int) -> tuple[int, int, bool]:
    start = min(first, whole - 1)
    end = min(first + length, whole) if length else whole
    return start, max(end - start, 1), first < whole and first + length <= whole


def _value(declared: Declaration, node: Node, name: str) -> int:
    """A parameter's value, the default where it is none that is allowed; empty is 0."""
    parameter = declared.parameter(name)
    assert parameter is not None
    value: Any = parameter.default
    if name in node.params:
        try:
            value = parameter.coerce(thaw(node.params[name]))
        except ParameterError:
            value = parameter.default
    return value or 0


def setting(node: str, region: Region) -> Operation:
    values = (region.left, region.top, region.width, region.height)
    return _set(node, dict(zip(PARAMETERS, values, strict=True)))


def as_it_was(node: Node) -> Operation:
    """Give the node the region it has, also where it is left at the default."""
    return _set(node.id, {name: thaw(node.params.get(name, ABSENT)) for name in PARAMETERS})


def whole(node: str) -> Operation:
    return _set(node, dict.fromkeys(PARAMETERS, ABSENT))


def _set(node: str, values: dict[str, Any]) -> Operation:
    operations = [set_parameter(node, name, value) for name, value in values.items()]
    return Together(operations, f"Set {node}'s region")
