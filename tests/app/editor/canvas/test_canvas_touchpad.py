"""Two fingers on a touchpad pan, pinching zooms; a mouse's wheel zooms as ever."""

import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QInputDevice, QNativeGestureEvent, QPointingDevice, QWheelEvent
from PySide6.QtWidgets import QApplication

NONE = Qt.MouseButton.NoButton
PLAIN = Qt.KeyboardModifier.NoModifier


@pytest.fixture
def touchpad():
    can = QInputDevice.Capability.Scroll | QInputDevice.Capability.Position
    fingers = QPointingDevice.PointerType.Finger
    return QPointingDevice("touchpad", 7, QInputDevice.DeviceType.TouchPad, fingers, can, 5, 3)


def scroll(canvas, pixels, angle, *, keys=PLAIN, phase=Qt.ScrollPhase.ScrollUpdate, device=None):
    port = canvas.view.viewport()
    at = QPointF(300, 200)
    words = [at, QPointF(port.mapToGlobal(at.toPoint())), pixels, angle, NONE, keys, phase, False]
    if device is not None:
        words += [Qt.MouseEventSource.MouseEventNotSynthesized, device]
    QApplication.sendEvent(port, QWheelEvent(*words))


def test_two_fingers_pan_by_what_they_move_and_pinching_zooms_about_them(opened, canvas, touchpad):
    opened("kodak_kir310")
    centre, zoom = canvas.view.visible_rect().center(), canvas.view.zoom
    scroll(canvas, QPoint(30, -12), QPoint(60, -24))
    moved = canvas.view.visible_rect().center() - centre
    assert moved.x() * zoom == pytest.approx(-30)
    assert moved.y() * zoom == pytest.approx(12)
    assert canvas.view.zoom == zoom
    view = canvas.view
    at = QPointF(250, 180)
    for value in (0.25, -0.2):
        fixed, zoom = view.scene_point(at), view.zoom
        pinch, on_screen = Qt.NativeGestureType.ZoomNativeGesture, view.viewport().mapToGlobal(at)
        event = QNativeGestureEvent(pinch, touchpad, 2, at, at, on_screen, value, QPointF())
        QApplication.sendEvent(view.viewport(), event)
        assert view.zoom == pytest.approx(zoom * (1 + value))
        after = view.pixel(fixed)
        assert max(abs(after.x() - at.x()), abs(after.y() - at.y())) <= 1
