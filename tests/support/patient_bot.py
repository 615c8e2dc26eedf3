"""Waits of the window's tests that end, but not because the machine is busy."""

from pytestqt.qtbot import QtBot

from child_process import PATIENCE_S

PATIENCE_MS = round(1000 * PATIENCE_S)


class PatientBot(QtBot):
    """pytest-qt's, whose waits are given up after 5 s."""

    def waitUntil(self, callback, *, timeout=PATIENCE_MS):  # noqa: N802
        super().waitUntil(callback, timeout=timeout)

    def waitSignal(self, signal, *, timeout=PATIENCE_MS, **choices):  # noqa: N802
        return super().waitSignal(signal, timeout=timeout, **choices)

    def waitExposed(self, widget, *, timeout=PATIENCE_MS):  # noqa: N802
        return super().waitExposed(widget, timeout=timeout)
