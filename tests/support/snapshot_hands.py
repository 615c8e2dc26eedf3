"""Hands of a person who keeps and compares snapshots in a window."""

from PySide6.QtCore import QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication

from core.editing.operations import set_parameter
from window_hands import CTRL, KEY, SHIFT, give_focus

PORT = "back.image"
PLAIN = Qt.KeyboardModifier.NoModifier


class Person:
    """Presses keys where the focus is, on a window with a network."""

    def __init__(self, window, idle):
        self.window = window
        self._idle = idle
        self.viewer = window.viewers.images[1]
        self.snapshots = window.snapshots

    def key(self, key, modifiers=PLAIN):
        QTest.keyClick(QApplication.focusWidget(), key, modifiers)
        self.idle()

    def idle(self):
        self._idle(self.window)

    def at_picture(self):
        give_focus(self.viewer.canvas)

    def blur(self, sigma):
        assert self.window.session.do(set_parameter("blur", "sigma_x_mrad", sigma))
        self.idle()

    def keep(self):
        self.at_picture()
        self.key(KEY.Key_K, CTRL)

    def open_list(self):
        self.key(KEY.Key_K, CTRL | SHIFT)
        return self.window.snapshots_view.list

    @property
    def status(self):
        return self.window.status.said("information")

    def drawn_at(self, row, column):
        """The grey of a dot of the picture as it is painted."""
        canvas = self.viewer.canvas
        image = canvas.grab().toImage()
        place = canvas.mapFromScene(canvas.view.mapViewToScene(QPointF(column, row)))
        return image.pixelColor(place * image.devicePixelRatio()).red()
