"""A line scanner's geometry by hand, and the blend of scales on polynomials."""

import math

import numpy as np
import pytest

from core.errors import ParameterError
from core.physics.sampling.platform_motion import (
    line_intervals_mrad,
    scale_nodes_mrad,
    scale_weights,
    view_angles_rad,
)

IN_FLIGHT = np.array([0.5, 0.6, 0.8, 1.0, 0.9, 0.7, 0.4])


def test_view_angles_are_equal_steps_about_nadir():
    found = view_angles_rad(columns=4, interval_mrad=200.0)
    np.testing.assert_allclose(found, [-0.3, -0.1, 0.1, 0.3], rtol=0, atol=1e-16)
    assert view_angles_rad(columns=1, interval_mrad=5e3) == [0.0]


def test_a_scan_to_one_side_of_nadir():
    found = view_angles_rad(columns=3, interval_mrad=200.0, look_angle_rad=0.5)
    np.testing.assert_allclose(found, [0.3, 0.5, 0.7], rtol=0, atol=1e-16)


def test_lines_close_up_with_the_range():
    """At 60° the ground is twice as far as at nadir: 3 m are 3 mrad and 1.5 mrad at 1000 m."""
    found = line_intervals_mrad(
        line_spacing_m=3.0, altitude_m=1000.0, view_angle_rad=[0.0, math.pi / 3, -math.pi / 3]
    )
    np.testing.assert_allclose(found, [3.0, 1.5, 1.5], rtol=1e-15)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_weights_are_exact_for_polynomials_of_the_scale(count):
    nodes = scale_nodes_mrad(intervals_mrad=IN_FLIGHT, count=count)
    assert len(set(nodes)) == count
    assert IN_FLIGHT.min() <= nodes.min() <= nodes.max() <= IN_FLIGHT.max()
    weights = scale_weights(nodes_mrad=nodes, intervals_mrad=IN_FLIGHT)
    for power in range(count):
        np.testing.assert_allclose(
            nodes**-power @ weights, IN_FLIGHT**-power, rtol=1e-12, err_msg=str(power)
        )


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: view_angles_rad(columns=4, interval_mrad=-1.0), "interval_mrad"),
        (lambda: view_angles_rad(columns=3, interval_mrad=1571.0), "interval_mrad"),
        (
            lambda: line_intervals_mrad(line_spacing_m=1, altitude_m=1, view_angle_rad=1.6),
            "view_angle_rad",
        ),
        (
            lambda: line_intervals_mrad(line_spacing_m=0, altitude_m=1, view_angle_rad=0),
            "line_spacing_m",
        ),
        (
            lambda: view_angles_rad(columns=3, interval_mrad=500.0, look_angle_rad=1.1),
            "look_angle_rad",
        ),
    ],
)
def test_bad_geometry_is_refused(call, told):
    with pytest.raises(ParameterError, match=told):
        call()
