"""What Init & Trans has to give where a module leaves it empty."""

from node_bench import NodeBench


def error_of(params, given):
    nodes = {
        "scene": ("test_scene", {}),
        "init": ("init_trans", given),
        "pixel": ("detector_mtf", params),
    }
    return NodeBench(None, nodes).error("pixel")


def test_all_that_is_missing_is_named_at_once():
    pitch_x, pitch_y, lens = (
        {"detector_x_um": 20.0},
        {"detector_y_um": 20.0},
        {"focal_length_mm": 100.0},
    )
    everything = error_of({}, {})
    assert everything.parameters == ("detector_x_um", "detector_y_um", "focal_length_mm")
    assert everything.message == (
        "detector_x_um, detector_y_um and focal_length_mm are empty: give values here or on "
        "Init & Trans"
    )
    assert error_of(pitch_x, pitch_y).message == (
        "focal_length_mm is empty: give a value here or on Init & Trans"
    )
    assert error_of(lens, pitch_x | pitch_y) is None
