"""Exit Pupils: the aperture while it is edited, its wavefront error in colour."""

from __future__ import annotations

from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QFontMetricsF, QImage, QPainter

from app.editor.declared_text import choice_text
from app.editor.evaluation.queries import Answer, Passing, Query
from app.editor.panels.illustrations.chart import Axis, Chart, brief, signed
from app.editor.panels.illustrations.illustration import NO_EVALUATION, DocumentIllustration
from app.editor.panels.illustrations.shrinking import shrunk
from app.editor.panels.illustrations.wavefront import (
    Wavefront,
    coloured,
    open_share,
    scaled,
    wavefront_of,
)
from app.editor.theme import Theme
from core.chain.engine import Plan
from core.chain.wires import Pupil
from core.modules.declaration import NodeContext
from core.names import thaw
from core.network.network import Node
from core.physics.optics.pupil_shapes import PupilShape, sample_pupil

_FILE = "file"
_MARGIN = 1.2  # of what is drawn around the aperture
_SIDE = 256  # pixels of the picture, along its longer side


class ExitPupilIllustration(DocumentIllustration):
    """The pupil on its array of samples; only the samples of a file need a query."""

    lines = 11.0
    pupil: Pupil | None = None
    """The geometric pupil that is shown."""
    _samples: SmallPupil | None = None
    _wavefront: Wavefront | None = None

    def shown_samples(self) -> tuple[float, float]:
        """Samples across and along that are drawn: of a small aperture, the middle of the array."""
        columns, rows = self._size()
        part = 1.0
        if self.pupil is not None and self.pupil.shape is not None:
            needed = _MARGIN * 2 * self.pupil.shape.radius
            while min(columns, rows) * part / 2 >= needed:
                part /= 2
        return columns * part, rows * part

    def queries(self) -> Sequence[Query]:
        return (PupilQuery(self.node),)

    def look(self, node: Node) -> None:
        """Show the shape; of a file the samples there are still."""
        self.pupil = self._wavefront = None
        if self._is_file():
            if self._samples is None:
                self.show_problem("waits for the file" if self.evaluator else NO_EVALUATION)
            return
        self._samples = None
        self.pupil = self._planned(node)
        self._wavefront = wavefront_of(self.pupil)
        self.describe(", ".join(self._facts()))
        self.show_problem("")

    def take(self, answer: Answer) -> None:
        """Show a file's samples; of all else the document is newer than an answer on its way."""
        self.prepare()
        if self._is_file():
            super().take(answer)

    def keep(self, value: SmallPupil) -> str:
        self._samples = value
        return ", ".join(self._facts())

    def draw(self, painter: QPainter, area: QRectF) -> None:
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
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        if self.pupil is not None and self.pupil.shape is not None:
            pixels = self._pixels(self.pupil.shape)
            high, wide = pixels.shape
            picture = QImage(pixels.data, wide, high, 4 * wide, QImage.Format.Format_RGB32)
            painter.drawImage(frame, picture)
        elif self._samples is not None:
            levels = self._samples.levels
            high, wide = levels.shape
            picture = QImage(levels.data, wide, high, wide, QImage.Format.Format_Grayscale8)
            painter.drawImage(frame, picture)

    def _pixels(self, shape: PupilShape) -> NDArray[np.uint32]:
        """The shape as it is drawn, what is open in the colour of its wavefront error."""
        wide, high = self.shown_samples()
        scale = _SIDE / max(wide, high)
        shape = scaled(shape, scale)
        rows, columns = max(1, round(high * scale)), max(1, round(wide * scale))
        errors = np.zeros((rows, columns))
        if self._wavefront is not None:
            waves = self._wavefront.waves / (self._wavefront.size or 1.0)
            down, across = (_places(count, shape.radius, len(waves)) for count in (rows, columns))
            errors = waves[np.ix_(down, across)]
        pixels = coloured(errors, self._colours())
        dark = QColor(light_and_dark(self.theme)[1]).rgb()
        pixels[sample_pupil(shape, rows=rows, columns=columns) == 0] = dark
        return pixels

    def _planned(self, node: Node) -> Pupil:
        """What the module makes of its parameters; of a geometric shape, that takes no time."""
        module: Any = self.session.library[node.module].build(thaw(node.params))
        module.check()
        pupil: Pupil = module.run(here=NodeContext(self.node)).pupil
        return pupil

    def _is_file(self) -> bool:
        return self.seen is not None and self.seen.params.get("shape") == _FILE

    def _size(self) -> tuple[int, int]:
        shown = self.pupil or self._samples
        return (shown.columns, shown.rows) if shown is not None else (1, 1)

    def _facts(self) -> list[str]:
        columns, rows = self._size()
        facts = [f"{columns} × {rows} samples"]
        if self._samples is not None:
            return ["file", *facts, f"{brief(100 * self._samples.open_share)} % transmitted"]
        if self.pupil is None or self.pupil.shape is None:
            return []
        shape = self.pupil.shape
        facts = [choice_text(shape.shape), *facts, f"diameter {brief(2 * shape.radius, 4)}"]
        facts.append(f"{100 * open_share(shape):.0f} % of the disc open")
        if self._wavefront is not None:
            facts.append(f"rms {brief(self._wavefront.rms)} waves")
        return facts

    def _colours(self) -> tuple[str, str, str]:
        return self.theme.curves[0], light_and_dark(self.theme)[0], self.theme.curves[3]


def _places(count: int, radius: float, side: int) -> NDArray[np.intp]:
    """Which of `side` samples of a wavefront, which cover the disc, lie at so many pixels."""
    share = (np.arange(count) - (count - 1) / 2) / radius
    return np.clip((share + 1) / 2 * side, 0, side - 1).astype(np.intp)


_SHADES = 64


def draw_scale(
    painter: QPainter, area: QRectF, end: float, colours: tuple[str, str, str], theme: Theme
) -> None:
    """The colours of a wavefront error from −`end` to `end` waves, and what they stand for."""
    shades = coloured(np.linspace(-1, 1, _SHADES)[np.newaxis], colours)
    image = QImage(shades.data, _SHADES, 1, 4 * _SHADES, QImage.Format.Format_RGB32)
    metrics = QFontMetricsF(painter.font())
    line = metrics.height()
    bar = QRectF(area.left(), area.top(), area.width() - line / 2, line * 0.7)
    painter.drawImage(bar, image)
    text = bar.translated(0, line * 0.85)
    text.setHeight(line)
    painter.setPen(QColor(theme.text))
    written = brief(end, 2)
    painter.drawText(text, Qt.AlignmentFlag.AlignLeft, signed(f"-{written}"))
    if metrics.horizontalAdvance(f"{written} waves {written}") + line * 2 < text.width():
        painter.drawText(text, Qt.AlignmentFlag.AlignHCenter, "waves")
    painter.drawText(text, Qt.AlignmentFlag.AlignRight, f"+{written}")


def light_and_dark(theme: Theme) -> tuple[str, str]:
    """The theme's lightest and darkest, for what is open and what is opaque."""
    dark, light = sorted((theme.base, theme.text), key=lambda name: QColor(name).lightness())
    return light, dark


# The query for the samples of a pupil that has no geometric shape.

MOST_SAMPLES = 256  # across or along, of what is drawn


@dataclass(frozen=True, eq=False)
class SmallPupil:
    """A pupil's transmission, ready to be drawn."""

    levels: NDArray[np.uint8]  # shape (high, wide): 0 opaque to 255 transparent, C order
    rows: int  # rows, columns: of the pupil array itself
    columns: int
    open_share: float  # mean transmission of the array


@dataclass(frozen=True)
class PupilQuery(Query):
    """What the file of an exit pupil holds."""

    urgency: ClassVar[int] = 1

    node: str

    def key(self, plan: Plan) -> Hashable:
        pupil: Pupil = plan.output(f"{self.node}.pupil")
        return pupil.key

    def answer(self, passing: Passing) -> SmallPupil | None:
        pupil: Pupil = passing.plan.output(f"{self.node}.pupil")
        if pupil.shape is not None:
            return None
        samples = passing.work.value(pupil.samples)
        small = shrunk(samples, MOST_SAMPLES)
        levels = np.rint(255 * np.clip(small, 0, 1)).astype(np.uint8)
        return SmallPupil(levels, pupil.rows, pupil.columns, float(samples.mean()))
