"""A spin box that steps through the bands of a picture, and shows their wavelengths."""

from __future__ import annotations

import math

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtGui import QValidator
from PySide6.QtWidgets import QSpinBox, QWidget

_FEWEST, _MOST = 2, 5  # decimals
UNIT = "µm"
_UNITS = {UNIT: 1.0, "μm": 1.0, "um": 1.0, "nm": 1e-3}  # micro sign, Greek mu


class WavelengthSpin(QSpinBox):
    """Its value is the place of a band; what is typed, a wavelength in µm or nm, gives the nearest.

    Parameters
    ----------
    name, description : str
        Of the control.
    parent : QWidget
        Qt's owner.

    Signals
    -------
    typed(wavelength)
        The person has typed a wavelength, in µm, and finished it.
    """

    typed = Signal(float)

    _centres: tuple[float, ...] = (0.0,)  # Qt measures texts while it makes the widget
    _decimals = _FEWEST

    def __init__(self, name: str, description: str, parent: QWidget) -> None:
        super().__init__(parent)
        self.setRange(0, 0)
        self.setObjectName(name)
        self.setAccessibleName(description)
        self.setToolTip(description)
        self.setKeyboardTracking(False)
        self._text = ""
        self.lineEdit().textEdited.connect(self._note)
        self.editingFinished.connect(self._finish)

    def set_centres(self, centres_um: tuple[float, ...]) -> None:
        """Step through these wavelengths."""
        if centres_um == self._centres:
            return
        self._centres = centres_um
        self._decimals = decimals_of(centres_um)
        self.setRange(0, len(centres_um) - 1)
        self.updateGeometry()

    def textFromValue(self, place: int) -> str:
        """The wavelength of a band."""
        place = min(place, len(self._centres) - 1)
        return f"{self._centres[place]:.{self._decimals}f} {UNIT}"

    def valueFromText(self, text: str) -> int:
        """The band nearest to a wavelength."""
        wavelength = _number(text)
        if wavelength is None:
            return self.value()
        return int(np.argmin(np.abs(np.array(self._centres) - wavelength)))

    def validate(self, text: str, position: int) -> object:
        """Whether it is a number, with its unit or without."""
        state = QValidator.State
        return (state.Intermediate if _number(text) is None else state.Acceptable, text, position)

    def _note(self, text: str) -> None:
        self._text = text

    def _finish(self) -> None:
        text, self._text = self._text, ""
        wavelength = _number(text)
        if wavelength is not None:
            self.typed.emit(wavelength)


def decimals_of(centres_um: tuple[float, ...]) -> int:
    """As many as tell neighbouring bands apart, and one more."""
    apart = np.abs(np.diff(centres_um))
    least = float(apart[apart > 0].min()) if np.any(apart > 0) else 1.0
    return min(max(math.ceil(-math.log10(least)) + 1, _FEWEST), _MOST)


def _number(text: str) -> float | None:
    """A wavelength in µm, typed in it or in a unit that stands behind it."""
    bare = text.replace(",", ".").strip()
    factor = 1.0
    for unit, in_um in _UNITS.items():
        if bare.endswith(unit):
            bare, factor = bare.removesuffix(unit), in_um
            break
    try:
        value = float(bare) * factor
    except ValueError:
        return None
    return value if math.isfinite(value) else None
