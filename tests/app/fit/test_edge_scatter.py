"""Errors from the scatter between edges, beside those of statistics of a mean."""

import json

import numpy as np
import pytest

from app.fit.chain_fit import student_factor, widened_by_scatter
from edge_truth import blur_network, gaussian_edge


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
