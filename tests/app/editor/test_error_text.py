"""Errors and parameters in the window's words."""

from app.editor.declared_text import error_text, label_of
from core.errors import DataError, ParameterError
from core.modules.declaration import declaration
from nodes.library import standard_library

ERROR = ParameterError("sigma_y_mrad", -1.0, "at least 0", unit="mrad", node="my blur")
SEVERAL = ParameterError(
    "detector_x_um", None, "give values", node="init", also=("detector_y_um", "fill_x")
)


def test_the_panels_label_and_the_nodes_name():
    empty = ParameterError("detector_x_um", None, "give it here", unit="µm", node="init")
    for error, on_node, text in (
        (ERROR, False, "σ y of my blur = -1.0 mrad is not allowed: must be at least 0"),
        (ERROR, True, "σ y = -1.0 mrad is not allowed: must be at least 0"),
        (empty, False, "Detector x of init is empty: give it here"),
        (SEVERAL, False, "Detector x, Detector y and Fill x of init are empty: give values"),
        (DataError("no samples", node="scene"), False, "scene: no samples"),
        (DataError("no samples", node="scene"), True, "no samples"),
    ):
        assert error_text(error, on_node=on_node) == text
    for name, label in (
        ("responsivity_A_per_W", "Responsivity"),
        ("dark_current_A_per_cm2", "Dark current density"),
        ("emva_dynamic_range_dB", "EMVA dynamic range"),
        ("k3", "k₃"),
        ("l_mrad", "l"),
    ):
        assert label_of(name) == label


def test_no_two_parameters_of_a_module_have_one_label():
    for key, module in standard_library().items():
        names = [label_of(one.name) for one in declaration(module).parameters]
        assert len(set(names)) == len(names), key
