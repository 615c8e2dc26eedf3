"""What stands on the panel of a module that the library does not have."""

from __future__ import annotations

import json

from PySide6.QtCore import Qt
from PySide6.QtWidgets import QGridLayout, QLabel, QVBoxLayout, QWidget

from app.editor.theme import Theme, set_ink
from core.names import shown, thaw
from core.network.network import Network


class UnknownBody(QWidget):
    """The parameters as the file has them, to be read only.

    Parameters
    ----------
    module, node : str
        Key of the module, and the node.
    why : str
        Why the library does not have it, where that is known.
    theme : Theme
        Colours.
    parent : QWidget
        The panel.
    """

    def __init__(
        self, module: str, node: str, why: str, theme: Theme, parent: QWidget | None = None
    ) -> None:
        super().__init__(parent)
        self.setObjectName("body")
        self._node = node
        self.note = QLabel(
            f"There is no module {shown(module)} in this library{why and f': {why}'}. The node is "
            "kept as it is, with these parameters, and is saved again; it computes nothing.",
            self,
        )
        self.note.setObjectName("unknown_module")
        self.note.setTextFormat(Qt.TextFormat.PlainText)
        self.note.setWordWrap(True)
        self._grid = QGridLayout()
        self._grid.setColumnStretch(1, 1)
        self._labels: list[QLabel] = []
        column = QVBoxLayout(self)
        column.setContentsMargins(8, 4, 8, 8)
        column.addWidget(self.note)
        column.addLayout(self._grid)
        self.set_theme(theme)

    def follow(self, before: Network | None, after: Network) -> None:
        """Show the parameters, where they were changed."""
        node = after.nodes[self._node]
        if before is not None and before.nodes.get(self._node) is node:
            return
        for label in self._labels:
            self._grid.removeWidget(label)
            label.deleteLater()
        self._labels = []
        for row, (name, value) in enumerate(sorted(node.params.items())):
            text = value if isinstance(value, str) else json.dumps(thaw(value), ensure_ascii=False)
            for column, words in enumerate((name, text)):
                label = QLabel(words, self)
                label.setTextFormat(Qt.TextFormat.PlainText)
                label.setWordWrap(True)
                self._grid.addWidget(label, row, column)
                self._labels.append(label)
            label.setObjectName(f"raw.{name}")
            label.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)

    def set_theme(self, theme: Theme) -> None:
        """Draw in these colours."""
        set_ink(self.note, theme.changed)
