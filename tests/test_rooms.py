"""The rooms of the source: imports go downwards, without a circle."""

import ast
from graphlib import TopologicalSorter

from child_process import ROOT

LAYERS = ("core", "nodes", "app", "imagechain")
ENTRY = "__main__.py"  # nothing imports it: it stands above everything, wherever it lies


def modules():
    """Dotted name of every module of the product, with its file."""
    found = {}
    for layer in LAYERS:
        for path in sorted((ROOT / layer).rglob("*.py")):
            parts = path.relative_to(ROOT).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


MODULES = modules()


def imported(path):
    """The modules of the product that a file imports, wherever in it."""
    wanted = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            wanted |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                wanted.add(inner if inner in MODULES else node.module)
    return wanted & MODULES.keys()


def folder(name):
    return name if MODULES[name].name == "__init__.py" else name.rpartition(".")[0]


def test_no_circle_of_files_and_folders_import_from_below_only():
    """A circle is a CycleError, which names what it goes through."""
    files = {name: imported(path) - {name} for name, path in MODULES.items()}
    TopologicalSorter(files).prepare()
    folders = {}
    for name, wanted in files.items():
        if MODULES[name].name != ENTRY:
            others = {folder(other) for other in wanted} - {folder(name)}
            folders.setdefault(folder(name), set()).update(others)
    TopologicalSorter(folders).prepare()
