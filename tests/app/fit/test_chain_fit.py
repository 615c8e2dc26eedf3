"""What a picture shows of parameters: spreads of chains whose bands differ."""

import json
import math

import numpy as np
import pytest

from app.fit.chain_fit import EdgeProblem, fit_chain, positive, student_factor, widened_by_scatter
from app.fit.chain_transfer import FreeParameter, free_parameters, places
from app.fit.picture_fit import edges_in
from core.chain.engine import Engine
from core.evaluation.work import Policy
from core.network.file import parse_network
from edge_truth import blur_network, gaussian_edge
from nodes.library import standard_library
from oversampled_camera import Camera, take, true_spread
from oversampled_scene import Scene, Shape


@pytest.mark.parametrize("sigma_mrad", [0.005, 0.3])
def test_parameters_are_sorted_whatever_the_band(sigma_mrad):
    """A faint blur has a wider band, and a finer table of spreads, than the same times 1.3."""
    network = blur_network(
        blur=("gaussian_mtf", {"sigma_x_mrad": sigma_mrad, "sigma_y_mrad": sigma_mrad})
    )
    library = standard_library()
    made = parse_network(json.dumps(network), library=library, name_of_source="blurs")
    free = free_parameters(["blur.sigma_x_mrad", "init.range_m=1:9"], made, library)
    engine = Engine(library)
    plan = engine.plan(made)
    work = engine.work(Policy("single", None, 1))
    picture = gaussian_edge(angle_deg=6.0, sigma=(0.6, 0.6), shape=(64, 64), noise=20.0)
    problem = EdgeProblem(engine, plan, work, free, edges_in(pictures=[picture])[0])
    problem.sort_out(np.array([sigma_mrad, 3.0]))
    assert problem.shown == {0}
    assert problem.noisy == frozenset()


ENDS = [(2.0, 100.0), (-8.0, 8.0), (-8.0, 9e9), (-1e-3, math.inf), (-math.inf, math.inf)]


@pytest.mark.parametrize("present", [None, 0.5, 3.0])
@pytest.mark.parametrize("ends", ENDS)
def test_a_fit_begins_within_the_range_of_its_parameter(ends, present):
    begun = places(FreeParameter("a.b", "a", "b", *ends, present, ""))
    assert len(begun) > 5
    assert ends[0] <= begun.min() < begun.max() <= ends[1]


def test_a_value_is_positive_where_its_sign_changes_nothing():
    library = standard_library()
    network = blur_network(optics=("diffraction_mtf", {"aperture_mm": 40.0}))
    made = parse_network(json.dumps(network), library=library, name_of_source="optics")
    free = free_parameters(["optics.defocus_waves", "optics.aperture_mm"], made, library)
    values = np.array([-0.3, 30.0])
    same, unsigned = positive(free, lambda v: float(100.0 * v[0] ** 2), values)
    assert (same.tolist(), unsigned) == ([0.3, 30.0], (0,))
    other, unsigned = positive(free, lambda v: float(100.0 * (v[0] + 0.3) ** 2), values)
    assert (other.tolist(), unsigned) == ([-0.3, 30.0], ())


# --- errors by the scatter between edges ---


def mean_of(values, samples):
    """A parameter that is seen directly, with an error of 1 a sample, at some edges."""
    edge = np.repeat(np.arange(len(values)), samples)
    residual = np.repeat(values, samples) - np.mean(values)
    return widened_by_scatter(jacobian=np.ones((len(edge), 1)), residual=residual, edge=edge)


def test_the_error_of_a_mean_is_that_of_its_scatter():
    values = np.array([3.0, 7.0, 4.0, 9.0, 5.0, 2.0])
    jacobian, edges = mean_of(values, 50)
    # s / √m, and Student's t for 68.27 % with 5 degrees of freedom is 1.1107 (tables).
    expected = values.std(ddof=1) / np.sqrt(6) * 1.1107
    assert 1 / np.linalg.norm(jacobian) == pytest.approx(expected, rel=1e-3)
    assert edges == pytest.approx([6.0])


def test_what_other_edges_show_is_not_widened():
    """The first parameter scatters between its edges; the second, at others, does not."""
    jacobian = np.zeros((80, 2))
    jacobian[:40, 0] = jacobian[40:, 1] = 1.0
    residual = np.zeros(80)
    residual[:40] = np.repeat([4.0, -4.0, 4.0, -4.0], 10)
    edge = np.repeat(np.arange(8), 10)
    wider, edges = widened_by_scatter(jacobian=jacobian, residual=residual, edge=edge)
    lengths = np.linalg.norm(wider, axis=0)
    assert lengths[0] < 0.6 * np.sqrt(40)
    assert lengths[1] == pytest.approx(np.sqrt(40))
    assert edges == pytest.approx([4.0, 4.0])


@pytest.mark.parametrize(("edges", "factor"), [(2, 1.8373), (1000, 1.0003)])
def test_few_edges_widen_by_students_factor(edges, factor):
    """Factors of 1 σ from tables of Student's t at 84.13 %."""
    assert student_factor(edges) == pytest.approx(factor, abs=5e-4)


def test_edges_that_are_not_ideal_give_a_number_with_the_error_of_their_scatter(works, tmp_path):
    network = blur_network(blur=("gaussian_mtf", {"sigma_x_mrad": 0.1, "sigma_y_mrad": 0.0666}))
    (tmp_path / "net.json").write_text(json.dumps(network), encoding="utf-8")
    # What the scene adds to a camera of 0.6 samples differs from edge to edge.
    own = (0.60, 0.70, 0.62, 0.75, 0.66)
    for number, sigma in enumerate(own):
        picture = gaussian_edge(
            angle_deg=5.0 + number, sigma=(sigma, sigma), shape=(48, 48), noise=6.0, seed=number
        )
        np.save(tmp_path / f"{number}.npy", picture)
    names = [f"{number}.npy" for number in range(len(own))]

    def fitted(*pictures):
        works(
            "fit", "net.json", "--to", *pictures, "--free", "blur.sigma_x_mrad",
            "--json", "fit.json",
        )  # fmt: skip
        return json.loads((tmp_path / "fit.json").read_text(encoding="utf-8"))

    result = fitted(*names)
    across = result["parameters"]["blur.sigma_x_mrad"]
    scatter = 0.1 * np.std(own, ddof=1) / np.sqrt(len(own))
    assert across["value"] == pytest.approx(0.1 * np.mean(own), abs=2 * scatter)
    # A deviation of five is itself known to 1 / sqrt(2 · 4), 35 %.
    assert 0.65 * scatter < across["sigma"] < 3 * scatter
    assert any("scatter between 5 edges" in line for line in result["warnings"])
    # Of two edges there is no scatter to take.
    lone = fitted(*names[2:4])
    assert lone["parameters"]["blur.sigma_x_mrad"] == {"value": None, "sigma": None, "unit": "mrad"}


# --- what lies beside an edge ---

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
    work = engine.work(Policy("double", None, 1))
    return EdgeProblem(engine, engine.plan(made), work, free, edges_in(pictures=[picture])[0])


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
