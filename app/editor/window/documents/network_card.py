"""A shipped network on the first page: its picture, name and description, as one button."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QPixmap, QPixmapCache, QResizeEvent
from PySide6.QtWidgets import QLabel, QSizePolicy, QToolButton, QVBoxLayout, QWidget

_PICTURE = QSize(14, 9)  # in lines of text
_MARGIN = 8


class NetworkCard(QToolButton):
    """A button as high as its description needs at its width.

    Parameters
    ----------
    name, title, about : str
        The network's short name, its own name, and what it shows.
    picture : Path
        Its thumbnail; there may be none.
    """

    def __init__(
        self, name: str, title: str, about: str, picture: Path, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName(f"welcome.{name}")
        self.setAccessibleName(title)
        self.setAccessibleDescription(about)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Preferred)
        self.picture = QLabel(self)
        self.picture.setPixmap(self._scaled(picture))
        self.title = QLabel(title, self)
        font = self.title.font()
        font.setBold(True)
        self.title.setFont(font)
        self.about = QLabel(about, self)
        column = self._column = QVBoxLayout(self)
        column.setContentsMargins(_MARGIN, _MARGIN, _MARGIN, _MARGIN)
        column.setSpacing(4)
        for label in (self.picture, self.title, self.about):
            label.setTextFormat(Qt.TextFormat.PlainText)
            label.setWordWrap(True)
            label.setAlignment(Qt.AlignmentFlag.AlignHCenter | Qt.AlignmentFlag.AlignTop)
            label.setAttribute(Qt.WidgetAttribute.WA_TransparentForMouseEvents)
            column.addWidget(label)
        self.about.setAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignTop)
        column.addStretch(1)

    def sizeHint(self) -> QSize:
        """Wide enough for the picture; as high as all of it is at its present width."""
        line = self.fontMetrics().height()
        width = max(self.width(), _PICTURE.width() * line + 2 * _MARGIN)
        return QSize(_PICTURE.width() * line + 2 * _MARGIN, self._needed(width))

    def minimumSizeHint(self) -> QSize:
        """The same: nothing of it is cut."""
        return self.sizeHint()

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Ask for the height that the new width needs."""
        super().resizeEvent(event)
        if event.size().width() != event.oldSize().width():
            self.updateGeometry()

    def _needed(self, width: int) -> int:
        return self._column.totalHeightForWidth(width)

    def _scaled(self, file: Path) -> QPixmap:
        """Sharp on screens of any scale; Qt holds it for the next window."""
        try:
            when = file.stat().st_mtime_ns
        except OSError:
            return QPixmap()
        ratio = self.devicePixelRatioF()
        line = self.fontMetrics().height()
        scaled = QPixmap()
        key = f"thumbnail {file} {when} {line} {ratio}"
        if QPixmapCache.find(key, scaled):
            return scaled
        picture = QPixmap(str(file))
        if picture.isNull():
            return picture
        room = _PICTURE * line * ratio
        keep, smooth = (
            Qt.AspectRatioMode.KeepAspectRatio,
            Qt.TransformationMode.SmoothTransformation,
        )
        scaled = picture.scaled(room, keep, smooth)
        scaled.setDevicePixelRatio(ratio)
        QPixmapCache.insert(key, scaled)
        return scaled
