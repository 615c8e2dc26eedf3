"""app → nodes → core, never back; and a run loads nothing that it does not need."""

from __future__ import annotations

import ast
import json
import os
import sys
from pathlib import Path

import pytest

from child_process import ROOT, finished

QT = {"PySide6", "PyQt6", "PyQt5", "shiboken6", "qtpy", "Qt", "NodeGraphQt", "pyqtgraph"}
LAYERS = {"core", "nodes", "app", "networks"}
STANDARD = set(sys.stdlib_module_names)

# What each layer may import beside the standard library and itself.
ALLOWED = {
    "core": {"numpy", "scipy"},
    "nodes": {"numpy", "scipy", "core", "OpenImageIO"},
}


def imports(path: Path) -> set[str]:
    """Full names of the modules that a file imports, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: write imports in full"
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def files(layer: str) -> list[Path]:
    return sorted((ROOT / layer).rglob("*.py"))


@pytest.mark.parametrize("layer", ALLOWED)
def test_layer_imports_only_what_it_may(layer):
    allowed = ALLOWED[layer] | STANDARD | {layer}
    wrong = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in files(layer)
        for name in imports(path)
        if name.split(".")[0] not in allowed
    }
    assert files(layer)
    assert not wrong


def test_only_the_editor_knows_qt():
    wrong = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in files("app")
        if ROOT / "app" / "editor" not in path.parents and path != ROOT / "app/command/edit.py"
        for name in imports(path)
        if name.split(".")[0] in QT
    }
    assert not wrong


def test_exactly_one_file_imports_the_node_graph():
    found = {
        str(path.relative_to(ROOT))
        for path in files("app")
        if {name.split(".")[0] for name in imports(path)} & {"NodeGraphQt", "Qt"}
    }
    assert len(found) == 1


@pytest.mark.parametrize("layer", ["core", "nodes", "app"])
def test_of_scipy_only_fft_and_special(layer):
    wrong = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in files(layer)
        for name in imports(path)
        if name.startswith("scipy.") and name.split(".")[1] not in ("fft", "special")
    }
    assert not wrong


@pytest.mark.parametrize("layer", ["core", "nodes"])
def test_no_opened_file_nor_mutable_global_at_import(layer):
    """Module level holds definitions and constants, no loops over data and no `open`."""
    wrong = set()
    for path in files(layer):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.For | ast.While | ast.With):
                wrong.add(f"{path.relative_to(ROOT)}: line {node.lineno}")
    assert not wrong


def loaded_by(words: list[str], folder: Path) -> set[str]:
    """Names of the modules that a command loads, in a process of its own."""
    program = (
        "import json, sys; from app.command.cli import main; code = main(sys.argv[1:]); "
        "print('\\n' + json.dumps([code, sorted(sys.modules)]))"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = finished([sys.executable, "-c", program, *words], folder=folder, env=environment)
    code, names = json.loads(done.stdout.splitlines()[-1])
    assert code == 0, done.stderr
    return set(names)


def test_run_loads_neither_qt_nor_what_only_reports_need(tmp_path):
    loaded = loaded_by(["run", "first_steps"], tmp_path)
    packages = {name.split(".")[0] for name in loaded}
    assert not packages & QT
    assert not packages & {"matplotlib", "rich", "OpenImageIO", "PIL"}
    of_scipy = {name.split(".")[1] for name in loaded if name.startswith("scipy.")}
    public = {name for name in of_scipy if not name.startswith("_")}
    assert public <= {"fft", "special", "version", "linalg"}


def test_a_trade_off_loads_neither_qt_nor_what_only_pictures_need(tmp_path):
    words = ["tradeoff", "first_steps", "--vary", "blur.sigma_x_mrad=0,1", "--output", "a.csv"]
    packages = {name.split(".")[0] for name in loaded_by(words, tmp_path)}
    assert not packages & (QT | {"matplotlib", "rich", "OpenImageIO", "PIL"})


def test_modules_loads_no_qt(tmp_path):
    packages = {name.split(".")[0] for name in loaded_by(["modules", "--json"], tmp_path)}
    assert not packages & (QT | {"matplotlib", "rich"})


def test_report_draws_without_a_display(tmp_path):
    words = ["run", "first_steps", "--report", str(tmp_path / "r.html")]
    loaded = loaded_by(words, tmp_path)
    assert "matplotlib" in loaded
    assert "matplotlib.pyplot" not in loaded
    assert not {name.split(".")[0] for name in loaded} & QT


def test_the_window_loads_neither_matplotlib_nor_signal(tmp_path):
    """What only reports need would double the time until the first picture."""
    words = ["edit", "first_steps", "--screenshot", str(tmp_path / "window.png")]
    loaded = loaded_by(words, tmp_path)
    assert "pyqtgraph" in loaded
    assert not loaded & {"matplotlib", "matplotlib.pyplot", "scipy.signal", "rich"}
