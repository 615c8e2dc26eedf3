"""What a picture shows of parameters: spreads of chains whose bands differ."""

import json

import numpy as np
import pytest

from app.fit.chain_fit import EdgeProblem, positive
from app.fit.chain_transfer import ChainAt
from app.fit.free_parameter import free_parameters
from app.fit.picture_fit import edges_in
from core.chain.engine import Engine
from core.evaluation.work import Policy
from core.network.file import parse_network
from edge_truth import blur_network, gaussian_edge
from nodes.library import standard_library


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
    chain = ChainAt(engine, plan, [parameter.target for parameter in free])
    problem = EdgeProblem(chain, work, free, edges_in(pictures=[picture]).patches)
    problem.sort_out(np.array([sigma_mrad, 3.0]))
    assert problem.shown == {0}
    assert problem.noisy == frozenset()


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
