"""Which band of files that have several is measured."""

from __future__ import annotations

from PySide6.QtWidgets import QSpinBox, QWidget

_NONE, _MOST = -1, 99_999
_ABOUT = "Which band of files that have several, counted from 0"


class BandBox(QSpinBox):
    """A band's number, or none: the only band there is, or the luminance of colours."""

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setObjectName("measure.band")
        self.setAccessibleName(_ABOUT)
        self.setToolTip(f"{_ABOUT}; –: their only one, or the luminance of colours")
        self.setRange(_NONE, _MOST)
        self.setPrefix("Band ")
        self.setSpecialValueText("Band –")
        self.setKeyboardTracking(False)
        self.setValue(_NONE)

    @property
    def band(self) -> int | None:
        """The band; None where none is chosen."""
        return None if self.value() == _NONE else self.value()

    def choose_none(self) -> None:
        """As at first."""
        self.setValue(_NONE)
