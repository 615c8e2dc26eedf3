"""What reaches into an edge's samples from beyond, against pictures made by oversampled sums."""

import json

import numpy as np

from app.fit.chain_fit import EdgeProblem, fit_chain
from app.fit.chain_transfer import ChainAt
from app.fit.free_parameter import free_parameters
from app.fit.picture_fit import edges_in
from core.chain.engine import Engine
from core.evaluation.work import Policy
from core.network.file import parse_network
from edge_truth import blur_network
from nodes.library import standard_library
from oversampled_camera import Camera, take, true_spread
from oversampled_scene import Scene, Shape

LOW, HIGH = 2000.0, 8000.0
CUTOFF, FOCAL_MM, WAVELENGTH_UM, PITCH_UM = 1.1, 100.0, 4.0, 10.0
APERTURE_MM = FOCAL_MM * WAVELENGTH_UM * CUTOFF / PITCH_UM
CAMERA = Camera(cutoff=CUTOFF, photons=False, read_e=12.0)


def turned(corners, angle_deg, middle):
    turn = np.radians(angle_deg)
    rotation = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    return np.asarray(corners, float) @ rotation.T + middle


def bars(angle_deg, width=10.0, count=4, length=90.0):
    """Bright bars as far apart as they are wide."""
    shapes = []
    for number in range(count):
        left = (2 * number - count + 0.5) * width
        corners = [(left, -length / 2), (left + width, -length / 2),
                   (left + width, length / 2), (left, length / 2)]  # fmt: skip
        shapes.append(Shape(turned(corners, angle_deg, (70.3, 64.6)), HIGH))
    return Scene(background=LOW, shapes=tuple(shapes))


def problem_of(picture):
    network = blur_network(
        interval_mrad=PITCH_UM / FOCAL_MM,
        optics=(
            "diffraction_mtf",
            {"aperture_mm": 0.7 * APERTURE_MM, "wavelengths": 1,
             "cut_on_um": WAVELENGTH_UM - 0.01, "cut_off_um": WAVELENGTH_UM + 0.01},
        ),
    )  # fmt: skip
    library = standard_library()
    made = parse_network(json.dumps(network), library=library, name_of_source="bars")
    free = free_parameters(["optics.aperture_mm"], made, library)
    engine = Engine(library)
    chain = ChainAt(engine, engine.plan(made), [one.target for one in free])
    work = engine.work(Policy("double", None, 1))
    return EdgeProblem(chain, work, free, edges_in(pictures=[picture]).patches)


def test_what_neighbours_add_is_what_a_picture_shows_of_them():
    frame = take(bars(8.0), CAMERA, rows=128, columns=140, seed=1)
    problem = problem_of(frame.picture)
    true_value = np.array([APERTURE_MM])
    for _ in range(5):
        problem.leave_out_surroundings(true_value)
    beyond = problem.beyond(true_value)
    left, added = [], []
    for patch, what in zip(problem.patches, beyond, strict=True):
        alone = true_spread(CAMERA, patch.edge.angle_deg, patch.distance)
        true = frame.clean[patch.row, patch.column] - LOW - (HIGH - LOW) * alone
        # Levels and inclines are each edge's own: of what is added, only the rest counts.
        along, off = patch.along, patch.distance
        moved = true_spread(CAMERA, patch.edge.angle_deg, off + 0.01)
        slope = moved - alone
        own = np.column_stack(
            [np.ones_like(off), alone, off, along, slope, slope * along, slope * along**2]
        )
        one, other = (v - own @ np.linalg.lstsq(own, v, rcond=None)[0] for v in (true, what))
        added.append(one)
        left.append(one - other)
    added, left = np.concatenate(added), np.concatenate(left)
    assert np.sqrt(np.mean(left**2)) < 0.35 * np.sqrt(np.mean(added**2))


def test_bars_do_not_move_the_aperture():
    """Taken for endless and alone, edges of bars show another aperture by many errors."""
    frame = take(bars(61.0), CAMERA, rows=128, columns=140, seed=2)
    problem = problem_of(frame.picture)
    fit = fit_chain(problem)
    sigma = 1.0 / np.linalg.norm(fit.jacobian)
    assert abs(fit.values[0] - APERTURE_MM) < 3.0 * sigma
    alone = problem_of(frame.picture)
    alone.leave_out_surroundings = lambda _values: 0.0
    without = fit_chain(alone)
    assert abs(without.values[0] - APERTURE_MM) > 5.0 * sigma
