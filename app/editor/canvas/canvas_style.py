"""Fonts, pens and colours of the canvas, made once for a theme.

Sizes are in units of the scene, in which networks store their layout: a node stands on a grid of
240 by 160 whatever the screen's font. `natural_zoom` is the zoom at which text of the canvas is as
large as that of the window.
"""

from collections.abc import Iterable, Sequence
from typing import Literal

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFont, QFontInfo, QFontMetricsF, QPen

from app.editor.declared_text import says_more
from app.editor.theme import Theme
from core.modules.declaration import Declaration, Port, package_of
from core.network.network import Link, Node
from core.records import dataclass

# What a node shows of itself, from its module's declaration or, for lack of one, its links.

COLOUR = "colour"  # field of a node in the file
Side = Literal["input", "output"]
INPUT: Side = "input"
OUTPUT: Side = "output"


@dataclass(frozen=True)
class NodeFace:
    """A node as it is drawn.

    `id`, the user's name for it, is its title; `module` the module's title, or its key where the
    library does not have it: then it is not `known` and has no `group`. `disabled`: it only passes
    its input through; `output`: its picture is marked as what the network delivers; `colour`: name
    of the one that the user gave it, empty for that of its group; `macro`: it holds nodes.
    """

    id: str
    module: str
    group: str
    summary: str
    inputs: tuple[Port, ...]
    outputs: tuple[Port, ...]
    known: bool = True
    disabled: bool = False
    output: bool = False
    colour: str = ""
    macro: bool = False

    @property
    def subtitle(self) -> str:
        """The module's title, where it is more than the name again."""
        return self.module if says_more(self.module, self.id) else ""

    @property
    def tooltip(self) -> str:
        state = " (disabled: the node passes its input through)" if self.disabled else ""
        mark = "\nThe node's picture is marked as the network's output." if self.output else ""
        within = "\nDouble-click or press Enter to show the nodes inside." if self.macro else ""
        return f"{self.id} · {self.module}{state}\n{self.summary}{mark}{within}"

    def ports(self, side: Side) -> tuple[Port, ...]:
        return self.inputs if side == "input" else self.outputs


def face_of(
    node: Node, declared: Declaration | None, links: Sequence[Link], *, output: bool = False
) -> NodeFace:
    """The face of a node with the links at it; ports that only a link names have no types."""
    inputs = declared.inputs if declared else ()
    outputs = declared.outputs if declared else ()
    package = package_of(node.module)
    of_package = f"; the module belongs to the package {package}" if package else ""
    absent = f"The library has no module {node.module}{of_package}."
    coming = (link.input for link in links if link.target == node.id)
    going = (link.output for link in links if link.source == node.id)
    colour = node.extra.get(COLOUR)
    return NodeFace(
        id=node.id,
        module=declared.title if declared else node.module,
        group=declared.group if declared else "",
        summary=declared.summary if declared else absent,
        inputs=inputs + _missing(inputs, coming),
        outputs=outputs + _missing(outputs, going),
        known=declared is not None,
        disabled=node.disabled,
        output=output,
        colour=colour if isinstance(colour, str) else "",
        macro=node.macro is not None,
    )


def _missing(known: tuple[Port, ...], names: Iterable[str]) -> tuple[Port, ...]:
    there = {port.name for port in known}
    return tuple(Port(name, ()) for name in dict.fromkeys(names) if name not in there)


TextRole = Literal["title", "id", "port"]

_PLAIN = 12  # units that the window's font is worth
_SIZES: dict[TextRole, int] = {"title": 13, "id": 12, "port": 12}


# Chosen so that the theme's text is read on them, contrast 4.5 or more; the tests measure it.
_TINTS = {  # of the dark theme, and of the light one
    "red": ("#7a2e35", "#f3c1c3"),
    "orange": ("#7a4a1e", "#f5d0a9"),
    "yellow": ("#665a17", "#efe3a0"),
    "green": ("#2c6138", "#c3e5c5"),
    "blue": ("#28538a", "#bfd7f5"),
    "violet": ("#5d3f86", "#ddcbf2"),
    "grey": ("#555b63", "#d3d6da"),
}
TINTS = tuple(_TINTS)


class CanvasStyle:
    def __init__(self, theme: Theme, font: QFont) -> None:
        self.theme = theme
        self.natural_zoom = max(QFontInfo(font).pixelSize(), 6) / _PLAIN
        self._font = font
        self._fonts: dict[tuple[int, bool], QFont] = {}
        self._metrics: dict[tuple[int, bool], QFontMetricsF] = {}
        self._widths: dict[tuple[TextRole, str], float] = {}
        self.text = QColor(theme.text)
        self.faint = QColor(theme.faint_text)
        self.node = QBrush(QColor(theme.node))
        self.border = QPen(QColor(theme.line), 1.2)
        self.dashed = QPen(self.faint, 1.4, Qt.PenStyle.DashLine)
        self.accent = QColor(theme.accent)
        self.error = QColor(theme.error)
        self._ports = {name: QColor(colour) for name, colour in theme.ports.items()}

    def is_of(self, theme: Theme, font: QFont) -> bool:
        return theme is self.theme and font == self._font

    def font(self, role: TextRole) -> QFont:
        return self.sized(_SIZES[role], bold=role == "title")

    def sized(self, size: int, *, bold: bool = False) -> QFont:
        font = self._fonts.get((size, bold))
        if font is None:
            font = QFont(self._font)
            font.setPixelSize(size)
            font.setBold(bold)
            # Hinted letters have other widths at every zoom.
            font.setHintingPreference(QFont.HintingPreference.PreferNoHinting)
            self._fonts[size, bold] = font
        return font

    def metrics(self, size: int, *, bold: bool = False) -> QFontMetricsF:
        if (size, bold) not in self._metrics:
            self._metrics[size, bold] = QFontMetricsF(self.sized(size, bold=bold))
        return self._metrics[size, bold]

    def width(self, role: TextRole, text: str) -> float:
        if (role, text) not in self._widths:
            metrics = self.metrics(_SIZES[role], bold=role == "title")
            self._widths[role, text] = metrics.horizontalAdvance(text)
        return self._widths[role, text]

    def elided(self, role: TextRole, text: str, width: float) -> str:
        if self.width(role, text) <= width:
            return text
        metrics = self.metrics(_SIZES[role], bold=role == "title")
        return metrics.elidedText(text, Qt.TextElideMode.ElideRight, width)

    def port(self, types: tuple[str, ...]) -> QColor:
        return self._ports.get(types[0], self.faint) if types else self.faint

    def lane(self, types: tuple[str, ...]) -> float:
        """How far beside nodes wires of this type run, so that those of others stay apart."""
        order = list(self._ports)
        return 9.0 + 5.0 * (order.index(types[0]) if types and types[0] in order else len(order))

    def tint(self, name: str) -> QColor | None:
        return QColor(_TINTS[name][self.theme.look == "light"]) if name in _TINTS else None

    def head(self, group: str) -> QColor:
        return QColor(self.theme.groups.get(group, self.theme.raised))


# Where the parts of a node lie, in units of the scene.

# A network's grid is 240 by 160: the gaps are for wires, and seven ports have to fit.
NARROWEST, WIDEST = 168.0, 200.0
HEAD, HEAD_WITH_ID = 24.0, 39.0
PORT_ROW = 15.0
PORT_RADIUS = 4.5
_PADDING = 9.0
_FOOT = 6.0
BADGE_ROOM = 20.0


@dataclass(frozen=True)
class NodeGeometry:
    width: float
    height: float
    head: float
    ports: dict[tuple[Side, str], QPointF]

    @property
    def frame(self) -> QRectF:
        return QRectF(0, 0, self.width, self.height)


def geometry_of(face: NodeFace, style: CanvasStyle) -> NodeGeometry:
    head = HEAD_WITH_ID if face.subtitle else HEAD
    title = style.width("title", face.id) + 2 * _PADDING + BADGE_ROOM
    rows = max(len(face.inputs), len(face.outputs))
    width = max(NARROWEST, title)
    for row in range(rows):
        texts = [ports[row].name for ports in (face.inputs, face.outputs) if row < len(ports)]
        width = max(width, sum(style.width("port", one) + _PADDING for one in texts) + _PADDING)
    width = min(width, WIDEST)
    height = head + rows * PORT_ROW + 2 * _FOOT
    ports: dict[tuple[Side, str], QPointF] = {}
    for x, side in ((0.0, INPUT), (width, OUTPUT)):
        for row, port in enumerate(face.ports(side)):
            y = head + _FOOT + (row + 0.5) * PORT_ROW
            ports[side, port.name] = QPointF(x, y)
    return NodeGeometry(width, height, head, ports)


def label_room(geometry: NodeGeometry, row: int, others: Sequence[Port]) -> float:
    """How wide a port's label may be; more where nothing stands on the other side of its row."""
    alone = row >= len(others)
    return geometry.width * (1.0 if alone else 0.62) - 2 * _PADDING
