"""imagechain → app → nodes → core, never back."""

import ast
import sys
from pathlib import Path

import pytest

from child_process import ROOT
from qt_packages import QT

LAYERS = {"core", "nodes", "app", "networks", "imagechain"}
STANDARD = set(sys.stdlib_module_names)

# What each layer may import beside the standard library and itself.
ALLOWED = {
    "core": {"numpy", "scipy"},
    "nodes": {"numpy", "scipy", "core", "OpenImageIO", "pybsm", "tifffile", "zarr"},
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


def test_physics_knows_no_network_and_no_engine():
    rooms = ("chain", "editing", "evaluation", "modules", "network", "transfer")
    wrong = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in files("core/physics")
        for name in imports(path)
        if name.startswith(tuple(f"core.{room}." for room in rooms))
    }
    assert not wrong


def test_nothing_below_the_package_knows_it():
    wrong = {
        f"{path.relative_to(ROOT)}: {name}"
        for layer in ("core", "nodes", "app")
        for path in files(layer)
        for name in imports(path)
        if name.split(".")[0] == "imagechain"
    }
    assert files("imagechain")
    assert not wrong


def test_the_package_leaves_the_window_and_heavy_libraries_alone():
    """Data frames and Dask are imported where they are wanted, by name; matplotlib for a report."""
    allowed = STANDARD | {"imagechain", "app", "nodes", "core", "numpy"}
    exceptions = {"pandas.DataFrame", "xarray.DataArray", "distributed.Client", "matplotlib"}
    wrong = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in files("imagechain")
        for name in imports(path) - exceptions
        if name.split(".")[0] not in allowed or name.startswith("app.editor")
    }
    assert not wrong


def test_only_the_editor_knows_qt():
    wrong = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in files("app")
        if ROOT / "app" / "editor" not in path.parents
        and path != ROOT / "app/command/run_commands.py"
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


@pytest.mark.parametrize("layer", ["core", "nodes", "app", "imagechain"])
def test_of_scipy_only_fft_and_special(layer):
    wrong = {
        f"{path.relative_to(ROOT)}: {name}"
        for path in files(layer)
        for name in imports(path)
        if name.startswith("scipy.") and name.split(".")[1] not in ("fft", "special")
    }
    # The fit's optimizer, and its splines; chains, distances and rising curves of edges.
    # Imported in functions, as test_loaded_modules sees to.
    assert wrong <= {
        "app/fit/chain_fit.py: scipy.optimize.least_squares",
        "core/physics/detector/readout.py: scipy.optimize.isotonic_regression",
        "core/physics/measurement/found_edge.py: scipy.ndimage",
        "core/physics/measurement/ridges.py: scipy.sparse.coo_array",
        "core/physics/measurement/ridges.py: scipy.sparse.csgraph.connected_components",
    }


@pytest.mark.parametrize("layer", ["core", "nodes"])
def test_no_opened_file_nor_mutable_global_at_import(layer):
    """Module level holds definitions and constants, no loops over data and no `open`."""
    wrong = set()
    for path in files(layer):
        for node in ast.parse(path.read_text()).body:
            if isinstance(node, ast.For | ast.While | ast.With):
                wrong.add(f"{path.relative_to(ROOT)}: line {node.lineno}")
    assert not wrong
