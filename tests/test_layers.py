"""imagechain → app → nodes → core, never back; imports go downwards, without a circle."""

import ast
import sys
from graphlib import TopologicalSorter

import pytest

from child_process import ROOT
from source_imports import QT, files, importing, imports, package

LAYERS = ("core", "nodes", "app", "imagechain")
STANDARD = set(sys.stdlib_module_names)
ENTRY = "__main__.py"  # nothing imports it: it stands above everything, wherever it lies

# What each layer may import beside the standard library and itself.
ALLOWED = {
    "core": {"numpy", "scipy"},
    "nodes": {"numpy", "scipy", "core", "OpenImageIO", "pybsm", "tifffile", "zarr"},
}


@pytest.mark.parametrize("layer", ALLOWED)
def test_layer_imports_only_what_it_may(layer):
    allowed = ALLOWED[layer] | STANDARD | {layer}
    assert files(layer)
    assert not importing(lambda name: package(name) not in allowed, layer)


def test_physics_knows_no_network_and_no_engine():
    rooms = ("chain", "editing", "evaluation", "modules", "network", "transfer")
    heads = tuple(f"core.{room}." for room in rooms)
    assert not importing(lambda name: name.startswith(heads), "core/physics")


def test_nothing_below_the_package_knows_it():
    assert files("imagechain")
    assert not importing(lambda name: package(name) == "imagechain", "core", "nodes", "app")


def test_the_package_leaves_the_window_and_heavy_libraries_alone():
    """Data frames and Dask are imported where they are wanted, by name; matplotlib for a report."""
    allowed = STANDARD | {"imagechain", "app", "nodes", "core", "numpy"}
    exceptions = {"pandas.DataFrame", "xarray.DataArray", "distributed.Client", "matplotlib"}

    def wrong(name):
        return name not in exceptions and (
            package(name) not in allowed or name.startswith("app.editor")
        )

    assert not importing(wrong, "imagechain")


def test_only_the_editor_knows_qt():
    known = importing(lambda name: package(name) in QT, "app")
    own = ("app/editor/", "app/command/run_commands.py: ")
    assert not {line for line in known if not line.startswith(own)}


def test_exactly_one_file_imports_the_node_graph():
    known = importing(lambda name: package(name) in {"NodeGraphQt", "Qt"}, "app")
    assert len({line.partition(": ")[0] for line in known}) == 1


def test_of_scipy_only_fft_and_special():
    light = ("scipy.fft", "scipy.special")
    wrong = importing(
        lambda name: name.startswith("scipy.") and not f"{name}.".startswith(light), *LAYERS
    )
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


def test_no_circle_of_files_and_folders_import_from_below_only():
    """A circle is a CycleError, which names what it goes through."""
    modules = {}
    for path in (path for layer in LAYERS for path in files(layer)):
        parts = path.relative_to(ROOT).with_suffix("").parts
        modules[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path

    def folder(name):
        return name if modules[name].name == "__init__.py" else name.rpartition(".")[0]

    wanted = {}
    for name, path in modules.items():
        names = {one if one in modules else one.rpartition(".")[0] for one in imports(path)}
        wanted[name] = names & modules.keys() - {name}
    TopologicalSorter(wanted).prepare()
    folders = {}
    for name in (name for name, path in modules.items() if path.name != ENTRY):
        others = {folder(other) for other in wanted[name]} - {folder(name)}
        folders.setdefault(folder(name), set()).update(others)
    TopologicalSorter(folders).prepare()
