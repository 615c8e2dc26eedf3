"""Exit Pupils: the aperture while it is edited, its wavefront error in colour."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from PySide6.QtCore import QRectF
from PySide6.QtGui import QBrush, QColor, QFontMetricsF, QImage, QPainter, QTransform
from PySide6.QtWidgets import QWidget

from app.editor.declared_text import choice_text
from app.editor.evaluation.evaluator import Evaluator
from app.editor.evaluation.queries import Query
from app.editor.panels.illustrations.illustration import NO_EVALUATION, Illustration
from app.editor.panels.illustrations.painting.axes import Axis
from app.editor.panels.illustrations.painting.chart import Chart
from app.editor.panels.illustrations.painting.few_digits import brief
from app.editor.panels.illustrations.painting.pupil_drawing import (
    draw_pupil,
    draw_scale,
    light_and_dark,
)
from app.editor.panels.illustrations.painting.wavefront import (
    Wavefront,
    coloured,
    open_share,
    wavefront_of,
)
from app.editor.panels.illustrations.queries.pupil_query import PupilQuery, SmallPupil
from app.editor.session import Session
from app.editor.theme import Theme
from core.chain.wires import Pupil
from core.errors import ImagechainError
from core.modules.declaration import NodeContext
from core.names import thaw
from core.network.network import Node

_FILE = "file"
_MARGIN = 1.2  # of what is drawn around the aperture


class ExitPupilIllustration(Illustration):
    """The pupil on its array of samples.

    A geometric shape is drawn straight from the document, without waiting for an answer; only the
    samples of a file need a query.
    """

    lines = 11.0

    def __init__(
        self,
        session: Session,
        evaluator: Evaluator | None,
        node: str,
        theme: Theme,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(session, evaluator, node, theme, parent)
        self._waits = False
        self._seen: Node | None = None
        self._pupil: Pupil | None = None
        self._samples: SmallPupil | None = None
        self._wavefront: Wavefront | None = None
        session.changed.connect(self._follow)
        self.prepare()

    @property
    def pupil(self) -> Pupil | None:
        """The geometric pupil that is shown."""
        return self._pupil

    def shown_samples(self) -> tuple[float, float]:
        """Samples across and along that are drawn: of a small aperture, the middle of the array."""
        columns, rows = self._size()
        part = 1.0
        if self._pupil is not None and self._pupil.shape is not None:
            needed = _MARGIN * 2 * self._pupil.shape.radius
            while min(columns, rows) * part / 2 >= needed:
                part /= 2
        return columns * part, rows * part

    def queries(self) -> Sequence[Query]:
        """The samples of a file."""
        return (PupilQuery(self.node),)

    def prepare(self) -> None:
        """Look at the node, if it has changed since."""
        node = self.present_node()
        if node is None or node is self._seen:
            return
        self._seen, self._pupil, self._wavefront = node, None, None
        if self._is_file():
            if self._samples is None:
                self.show_problem("waits for the file" if self._evaluator else NO_EVALUATION)
            return
        self._samples = None
        try:
            self._pupil = self._planned(node)
            self._wavefront = wavefront_of(self._pupil)
        except ImagechainError as error:
            self.show_problem(error.message)
            return
        self.describe(", ".join(self._facts()))
        self.show_problem("")

    def take(self, value: Any) -> str:
        """Keep a file's samples."""
        self._samples = value
        return ", ".join(self._facts())

    def draw(self, painter: QPainter, area: QRectF) -> None:
        """Paint the array with its axes, and its numbers beside."""
        line = QFontMetricsF(painter.font()).height()
        wide, high = self.shown_samples()
        width = min(area.width() * 0.62, area.height())
        chart = Chart(
            painter,
            QRectF(area.left(), area.top(), width, area.height()),
            Axis(-wide / 2, wide / 2, "samples"),
            Axis(high / 2, -high / 2),
            self.theme,
            square=True,
        )
        self._paint_pupil(painter, chart.frame)
        beside = area.adjusted(chart.frame.right() + line * 0.8 - area.left(), line * 0.4, 0, 0)
        if self._wavefront is not None:
            beside.setBottom(beside.bottom() - line * 2.4)
            bar = QRectF(beside.left(), beside.bottom(), beside.width(), line * 2)
            draw_scale(painter, bar, self._wavefront.size, self._colours(), self.theme)
        self.write(painter, beside, self._facts())

    def _paint_pupil(self, painter: QPainter, frame: QRectF) -> None:
        if self._pupil is not None and self._pupil.shape is not None:
            light, dark = light_and_dark(self.theme)
            brush = self._texture(self._pupil.shape.radius) or QBrush(QColor(light))
            size = self.shown_samples()
            draw_pupil(painter, frame, self._pupil.shape, size, brush, QColor(dark))
        elif self._samples is not None:
            levels = self._samples.levels
            high, wide = levels.shape
            picture = QImage(levels.data, wide, high, wide, QImage.Format.Format_Grayscale8)
            painter.drawImage(frame, picture)

    def _planned(self, node: Node) -> Pupil:
        """What the module makes of its parameters; of a geometric shape, that takes no time.

        Raises
        ------
        ImagechainError
            For parameters that make no pupil.
        """
        module: Any = self.session.library[node.module].build(thaw(node.params))
        module.check()
        pupil: Pupil = module.run(here=NodeContext(self.node)).pupil
        return pupil

    def _is_file(self) -> bool:
        return self._seen is not None and self._seen.params.get("shape") == _FILE

    def _size(self) -> tuple[int, int]:
        shown = self._pupil or self._samples
        return (shown.columns, shown.rows) if shown is not None else (1, 1)

    def _facts(self) -> list[str]:
        columns, rows = self._size()
        facts = [f"{columns} × {rows} samples"]
        if self._samples is not None:
            return ["file", *facts, f"{brief(100 * self._samples.open_share)} % transmitted"]
        if self._pupil is None or self._pupil.shape is None:
            return []
        shape = self._pupil.shape
        facts = [choice_text(shape.shape), *facts, f"diameter {brief(2 * shape.radius, 4)}"]
        facts.append(f"{100 * open_share(shape):.0f} % of the disc open")
        if self._wavefront is not None:
            facts.append(f"rms {brief(self._wavefront.rms)} waves")
        return facts

    def _colours(self) -> tuple[str, str, str]:
        return self.theme.curves[0], light_and_dark(self.theme)[0], self.theme.curves[3]

    def _texture(self, radius: float) -> QBrush | None:
        """The wavefront error in colour, in samples from the centre."""
        if self._wavefront is None:
            return None
        waves = self._wavefront.waves / (self._wavefront.size or 1.0)
        side = len(waves)
        pixels = coloured(waves, self._colours())
        image = QImage(pixels.data, side, side, 4 * side, QImage.Format.Format_RGB32)
        brush = QBrush(image.copy())
        scale, start = 2 * radius / side, -radius
        brush.setTransform(QTransform(scale, 0, 0, scale, start, start))
        return brush

    def _follow(self, _before: object, _after: object) -> None:
        if self.session.resolved.node(self.node) is not self._seen:
            self.update()

    def _answered(self, answer: Any) -> None:
        self.prepare()
        if self._is_file():  # of all else the document is newer than an answer on its way
            super()._answered(answer)
