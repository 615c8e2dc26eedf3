"""A command loads nothing that it does not need; each in a process of its own."""

import json
import os
import sys
from pathlib import Path

import pytest

from child_process import ROOT, finished
from source_imports import QT, package

DRAWING = {"matplotlib", "rich", "OpenImageIO", "PIL"}


def loaded_by(words: list[str], folder: Path, ends: int = 0) -> set[str]:
    """Names of the modules that a command loads, in a process of its own that ends so."""
    program = (
        "import json, sys; from app.command.cli import main; code = main(sys.argv[1:]); "
        "print('\\n' + json.dumps([code, sorted(sys.modules)]))"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = finished([sys.executable, "-c", program, *words], folder=folder, env=environment)
    code, names = json.loads(done.stdout.splitlines()[-1])
    assert code == ends, done.stderr
    return set(names)


@pytest.mark.parametrize(
    ("words", "ends"),
    [("--help", 0), ("networks", 0), ("solve --help", 0), ("run --saev=a", 2), ("run nosuch", 2)],
)
def test_help_lists_and_slips_load_no_numbers(words, ends, tmp_path):
    packages = set(map(package, loaded_by(words.split(), tmp_path, ends)))
    assert not packages & (QT | {"numpy", "scipy"})


def test_run_loads_neither_qt_nor_what_only_reports_need(tmp_path):
    packages = set(map(package, loaded_by(["run", "first_steps"], tmp_path)))
    assert not packages & (QT | DRAWING | {"tifffile", "zarr", "scipy"})


@pytest.mark.parametrize("command", ["tradeoff", "study"])
def test_studies_load_neither_qt_nor_what_only_pictures_need(command, tmp_path):
    words = [command, "first_steps", "--vary", "blur.sigma_x_mrad=0,1", "--output", "a.csv"]
    words += ["--jobs", "1"] if command == "study" else []
    packages = set(map(package, loaded_by(words, tmp_path)))
    assert not packages & (QT | DRAWING)
    if command == "study":
        assert not packages & {"dask", "distributed", "pandas", "pyarrow", "xarray", "zarr"}


def test_report_draws_without_a_display(tmp_path):
    words = ["run", "first_steps", "--report", str(tmp_path / "r.html")]
    loaded = loaded_by(words, tmp_path)
    assert "matplotlib" in loaded
    assert "matplotlib.pyplot" not in loaded
    assert not set(map(package, loaded)) & QT


def test_the_window_loads_neither_matplotlib_nor_signal(tmp_path):
    """What only reports need would double the time until the first picture."""
    words = ["edit", "first_steps", "--screenshot", str(tmp_path / "window.png")]
    loaded = loaded_by(words, tmp_path)
    assert "pyqtgraph" in loaded
    assert not loaded & {"matplotlib", "matplotlib.pyplot", "scipy.signal", "rich"}
