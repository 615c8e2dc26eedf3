"""Packages that are Qt, or load it."""

QT = {"PySide6", "PyQt6", "PyQt5", "shiboken6", "qtpy", "Qt", "NodeGraphQt", "pyqtgraph"}
