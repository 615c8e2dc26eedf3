"""How wide a widget is to be for a text that changes many times a second.

After a change of a widget's size hint all around it is laid out anew, up to the window: 2.5 ms for
each answer of a drag.
"""

from __future__ import annotations

import math

from PySide6.QtGui import QFont, QFontMetricsF


def steady_width(text: str, font: QFont, had: int) -> int:
    """The width there was, unless the text needs more, or less than half of it; in dots."""
    needed = math.ceil(QFontMetricsF(font).horizontalAdvance(text))
    return had if had // 2 <= needed <= had else needed
