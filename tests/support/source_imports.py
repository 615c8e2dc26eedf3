"""Which modules files of source import."""

import ast

from child_process import ROOT

QT = {"PySide6", "PyQt6", "PyQt5", "shiboken6", "qtpy", "Qt", "NodeGraphQt", "pyqtgraph"}


def imports(path):
    """Full names of what a file imports, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: write imports in full"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def package(name):
    """What a full name begins with."""
    return name.partition(".")[0]


def files(folder):
    """Files of source below a folder of the repository."""
    return sorted((ROOT / folder).rglob("*.py"))


def importing(wrong, *folders):
    """Files below the folders, each with a name that it imports and of which that is so."""
    return {
        f"{path.relative_to(ROOT).as_posix()}: {name}"
        for folder in folders
        for path in files(folder)
        for name in imports(path)
        if wrong(name)
    }
