"""The text of a module, to be read at leisure."""

from __future__ import annotations

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QDialog, QDialogButtonBox, QPlainTextEdit, QVBoxLayout, QWidget

from app.editor.declared_text import flowing
from core.modules.declaration import Declaration

_WIDE, _HIGH = 96, 34  # letters, lines


class ModuleText(QDialog):
    """A window with what a module does; it scrolls where that is long.

    Signals
    -------
    more_wanted(key)
        The module's page in the handbook is to be opened.
    """

    more_wanted = Signal(str)

    def __init__(self, declared: Declaration, parent: QWidget) -> None:
        super().__init__(parent)
        self.setObjectName("module_help")
        self.setWindowTitle(declared.title)
        self.text = QPlainTextEdit(flowing(declared.text), self)
        self.text.setReadOnly(True)
        self.text.setObjectName("module_help.text")
        self.text.setAccessibleName(f"What {declared.title} does")
        self.text.setTabChangesFocus(True)
        self.text.setTextInteractionFlags(
            Qt.TextInteractionFlag.TextSelectableByMouse
            | Qt.TextInteractionFlag.TextSelectableByKeyboard
        )
        buttons = QDialogButtonBox(QDialogButtonBox.StandardButton.Close, self)
        self.more = buttons.addButton(
            "More in the &Handbook", QDialogButtonBox.ButtonRole.ActionRole
        )
        self.more.setObjectName("module_help.more")
        self.more.setToolTip("Formulas, sources, curves and an example, in the browser (F1)")
        self.more.setShortcut("F1")
        self.more.clicked.connect(lambda *_: self.more_wanted.emit(declared.key))
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addWidget(self.text)
        layout.addWidget(buttons)
        metrics = self.fontMetrics()
        self.resize(metrics.averageCharWidth() * _WIDE, metrics.height() * _HIGH)
