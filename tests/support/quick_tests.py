"""Which tests are quick: together they take about a minute on two cores.

A rule of files, since time goes by what a file starts: Qt, processes, large pictures. Those that
are left out test what others test as well, at more length or in the whole program.
"""

from pathlib import Path

TESTS = Path(__file__).resolve().parents[1]

_FOLDERS = ("core",)
_SLOW = {
    "core/editing/test_sessions.py",
    "core/physics/acquisition/test_eye.py",
    "core/physics/optics/test_pupil_otf.py",
    "core/physics/optics/test_wavefront.py",
    "core/physics/detector/test_readout.py",
    "core/physics/measurement/test_slanted_edge.py",
    "core/physics/sampling/test_platform_motion.py",
    "core/network/test_network_mutations.py",
    "core/chain/test_random_fields.py",
    "core/transfer/test_planar_blocks.py",
}
_FILES = {
    "app/editor/canvas/test_canvas_adding.py",
    "app/editor/canvas/test_canvas_following.py",
    "app/editor/canvas/test_canvas_moving.py",
    "app/editor/canvas/test_canvas_wiring.py",
    "app/editor/evaluation/test_evaluator_badges.py",
    "app/editor/library/test_library_view.py",
    "app/editor/window/test_opening.py",
    "app/editor/viewers/test_picture_query.py",
    "app/command/test_bad_networks.py",
    "app/run/test_transfer_chain.py",
    "nodes/test_library_declarations.py",
    "test_layers.py",
}


def is_quick(path: Path) -> bool:
    """Whether the tests of a file are."""
    name = path.relative_to(TESTS).as_posix()
    return name in _FILES or (name.startswith(_FOLDERS) and name not in _SLOW)


def named() -> list[Path]:
    """The files that are named here."""
    return [TESTS / name for name in sorted(_FILES | _SLOW)]
