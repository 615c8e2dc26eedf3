"""A line scanner's mixed sampling against geometry by hand and direct sums over samples."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from core.errors import DataError, ParameterError
from core.physics.line_scanner import (
    filter_line_by_line,
    line_intervals_mrad,
    scale_nodes_mrad,
    scale_weights,
    view_angles_rad,
)

ROWS, COLUMNS, ACROSS = 9, 7, 0.8
IN_FLIGHT = np.array([0.5, 0.6, 0.8, 1.0, 0.9, 0.7, 0.4])


def blur(xi, eta):
    """Does not separate, and has a zero: neither a modulus nor a product would do."""
    return np.cos(0.9 * np.hypot(xi, 2.0 * eta)) * np.exp(-0.7 * xi**2 - 0.3 * eta**2)


def mean_of_three_lines(frame):
    """Each line with its neighbours; beyond the first and the last they are those again."""
    rows = len(frame)
    found = np.zeros_like(frame)
    for row in range(rows):
        for neighbour in (row - 1, row, row + 1):
            found[row] += frame[min(max(neighbour, 0), rows - 1)] / 3
    return found


@pytest.fixture
def frame():
    return np.random.default_rng(11).uniform(20.0, 60.0, (ROWS, COLUMNS))


def test_view_angles_are_equal_steps_about_nadir():
    found = view_angles_rad(columns=4, interval_mrad=200.0)
    np.testing.assert_allclose(found, [-0.3, -0.1, 0.1, 0.3], rtol=0, atol=1e-16)
    assert view_angles_rad(columns=1, interval_mrad=5e3) == [0.0]


def test_lines_close_up_with_the_range():
    """At 60° the ground is twice as far as at nadir: 3 m are 3 mrad and 1.5 mrad at 1000 m."""
    found = line_intervals_mrad(
        line_spacing_m=3.0, altitude_m=1000.0, view_angle_rad=[0.0, math.pi / 3, -math.pi / 3]
    )
    np.testing.assert_allclose(found, [3.0, 1.5, 1.5], rtol=1e-15)


@given(angle=st.floats(-1.5, 1.5), altitude=st.floats(1.0, 1e5), spacing=st.floats(1e-3, 1e2))
def test_interval_times_range_is_the_spacing(angle, altitude, spacing):
    """The range from the triangle of altitude and ground distance, not from a cosine."""
    range_m = math.hypot(altitude, altitude * math.tan(angle))
    found = line_intervals_mrad(line_spacing_m=spacing, altitude_m=altitude, view_angle_rad=angle)
    assert float(found) * range_m == pytest.approx(1000.0 * spacing, rel=1e-13)


def test_each_column_is_the_frame_filtered_at_that_columns_interval(frame):
    """Against matrices of cosines, one whole frame for each column's interval."""
    got = filter_line_by_line(
        frame, transfer=blur, interval_x_mrad=ACROSS, intervals_y_mrad=IN_FLIGHT
    )
    kx, ky = np.arange(COLUMNS), np.arange(ROWS)
    wave_x = np.cos(np.pi * np.outer(2 * kx + 1, kx) / (2 * COLUMNS))
    wave_y = np.cos(np.pi * np.outer(2 * ky + 1, ky) / (2 * ROWS))
    twice_x, twice_y = np.where(kx == 0, 1, 2) / COLUMNS, np.where(ky == 0, 1, 2) / ROWS
    spectrum = (wave_y.T @ frame @ wave_x) * np.outer(twice_y, twice_x)
    for column, interval in enumerate(IN_FLIGHT):
        xi, eta = kx / (2 * COLUMNS * ACROSS), ky / (2 * ROWS * interval)
        whole = wave_y @ (spectrum * blur(xi[None, :], eta[:, None])) @ wave_x.T
        np.testing.assert_allclose(got[:, column], whole[:, column], rtol=0, atol=1e-12)


def test_ground_blur_of_three_lines(frame):
    """A transfer function with no blur across and one line spacing either way at a column's scale
    is a mean of three neighbouring lines there."""
    column, interval = 2, IN_FLIGHT[2]

    def three(xi, eta):
        return (1.0 + 2.0 * np.cos(2.0 * np.pi * interval * eta)) / 3.0 + 0.0 * xi

    got = filter_line_by_line(
        frame, transfer=three, interval_x_mrad=ACROSS, intervals_y_mrad=IN_FLIGHT
    )
    expected = mean_of_three_lines(frame)
    np.testing.assert_allclose(got[:, column], expected[:, column], rtol=0, atol=1e-12)
    assert np.abs(got - expected).max() > 0.1  # elsewhere the lines are seen at other angles


def test_mean_is_kept_and_nothing_filtered_is_the_frame(frame):
    same = {"interval_x_mrad": ACROSS, "intervals_y_mrad": IN_FLIGHT}
    got = filter_line_by_line(frame, transfer=lambda xi, eta: 1.0 + 0.0 * (xi + eta), **same)
    np.testing.assert_allclose(got, frame, rtol=0, atol=1e-12)
    flat = filter_line_by_line(np.full((ROWS, COLUMNS), 7.0), transfer=blur, **same)
    np.testing.assert_allclose(flat, 7.0, rtol=1e-14)


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


def test_blended_frames_close_in_on_line_by_line(frame):
    """Whole frames filtered at a few intervals, blended: the error falls geometrically."""
    expected = filter_line_by_line(
        frame, transfer=blur, interval_x_mrad=ACROSS, intervals_y_mrad=IN_FLIGHT
    )
    errors = []
    for count in (2, 4, 8, 16):
        nodes = scale_nodes_mrad(intervals_mrad=IN_FLIGHT, count=count)
        frames = [
            filter_line_by_line(
                frame,
                transfer=blur,
                interval_x_mrad=ACROSS,
                intervals_y_mrad=np.full(COLUMNS, node),
            )
            for node in nodes
        ]
        weights = scale_weights(nodes_mrad=nodes, intervals_mrad=IN_FLIGHT)
        blended = np.einsum("nc,nrc->rc", weights, np.array(frames))
        errors.append(np.abs(blended - expected).max())
    assert all(later < 0.1 * earlier for earlier, later in pairwise(errors))
    assert errors[-1] < 1e-10


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda: view_angles_rad(columns=0, interval_mrad=1.0), "columns"),
        (lambda: view_angles_rad(columns=4, interval_mrad=-1.0), "interval_mrad"),
        (lambda: view_angles_rad(columns=3, interval_mrad=1571.0), "interval_mrad"),
        (
            lambda: line_intervals_mrad(line_spacing_m=1, altitude_m=1, view_angle_rad=1.6),
            "view_angle_rad",
        ),
        (
            lambda: line_intervals_mrad(line_spacing_m=1, altitude_m=1, view_angle_rad=math.nan),
            "view_angle_rad",
        ),
        (
            lambda: line_intervals_mrad(line_spacing_m=0, altitude_m=1, view_angle_rad=0),
            "line_spacing_m",
        ),
        (lambda: scale_nodes_mrad(intervals_mrad=[1.0], count=0), "count"),
        (lambda: scale_nodes_mrad(intervals_mrad=[], count=1), "interval"),
        (lambda: scale_weights(nodes_mrad=[1.0], intervals_mrad=[1.0, 0.0]), "interval"),
        (
            lambda: filter_line_by_line(
                np.ones((2, 2)), transfer=blur, interval_x_mrad=0.0, intervals_y_mrad=[1.0, 1.0]
            ),
            "interval_x_mrad",
        ),
    ],
)
def test_bad_geometry_is_refused(call, told):
    with pytest.raises(ParameterError, match=told):
        call()


@pytest.mark.parametrize("shape", [(2, 3), (2,)])
def test_an_interval_for_each_column(shape):
    with pytest.raises(DataError, match="interval for each column"):
        filter_line_by_line(
            np.ones(shape), transfer=blur, interval_x_mrad=1.0, intervals_y_mrad=[1.0, 1.0]
        )
