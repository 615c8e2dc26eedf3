"""Painting an exit pupil from its geometry: what is open, and what obstructs it."""

from __future__ import annotations

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QBrush, QColor, QFontMetricsF, QImage, QPainter, QPolygonF

from app.editor.panels.illustrations.painting.few_digits import brief, signed
from app.editor.panels.illustrations.painting.wavefront import coloured
from app.editor.theme import Theme
from core.physics.optics.pupil_shapes import PupilShape, vane_direction

_SHADES = 64


def draw_pupil(
    painter: QPainter,
    box: QRectF,
    shape: PupilShape,
    size: tuple[float, float],
    light: QBrush,
    dark: QColor,
) -> None:
    """Paint the middle of a pupil array into a box.

    Parameters
    ----------
    painter : QPainter
        Paints it.
    box : QRectF
        Where it is to be; y runs downwards, as rows do.
    shape : PupilShape
        The pupil, lengths in samples.
    size : (float, float)
        Samples across and along that the box shows.
    light : QBrush
        What is transparent; a texture lies in samples from the centre.
    dark : QColor
        What is opaque.
    """
    painter.save()
    painter.setClipRect(box)
    painter.setPen(Qt.PenStyle.NoPen)
    painter.translate(box.center())
    painter.scale(box.width() / size[0], box.height() / size[1])
    wide, high = size[0] / 2, size[1] / 2
    painter.fillRect(QRectF(-wide, -high, 2 * wide, 2 * high), dark)
    radius, inner = shape.radius, shape.inner_radius
    painter.setBrush(light)
    if shape.shape == "half_moon":
        around = QRectF(-radius, -radius, 2 * radius, 2 * radius)
        painter.drawChord(around, -90 * 16, 180 * 16)
    else:
        painter.drawEllipse(QPointF(), radius, radius)
    painter.setBrush(dark)
    if inner > 0:
        painter.drawEllipse(QPointF(), inner, inner)
    if shape.bar_width > 0:
        painter.drawRect(QRectF(-shape.bar_width / 2, -radius, shape.bar_width, 2 * radius))
    for index in range(shape.vane_count):
        cos, sin = vane_direction(index=index, count=shape.vane_count)
        along = QPointF(cos, sin) * (1.01 * radius)
        across = QPointF(-sin, cos) * (shape.vane_width / 2)
        painter.drawPolygon(QPolygonF([across, along + across, along - across, -across]))
    painter.restore()


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
