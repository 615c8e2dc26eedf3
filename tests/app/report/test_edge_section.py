"""The section on the measured MTF: what its table and its picture say of each measurement."""

import numpy as np

from app.report.edge_measurement import judged
from app.report.html_page import Grid


def measurement(direction, method, *, count=129, nyquist=2.0, mtf50=1.25):
    frequency = np.linspace(0, 0.5, count)
    return {
        "direction": direction,
        "method": method,
        "reason": None,
        "frequency_cyc_per_sample": frequency,
        "expected": np.exp(-frequency),
        "mtf": np.exp(-1.1 * frequency),
        "mtf_error": np.full(count, 0.01),
        "mtf50_cyc_per_mrad": mtf50,
        "mtf50_error_cyc_per_mrad": 0.02,
        "expected_mtf50_cyc_per_mrad": mtf50 + 0.5,
        "at_nyquist": 0.125,
        "at_nyquist_error": 0.0,
        "expected_at_nyquist": 0.25,
        "largest_difference": -0.064,
        "largest_difference_at_cyc_per_mrad": nyquist,
    }


def facts_of(*measurements):
    stages = {"frequency_cyc_per_sample": np.array([0.0, 0.5]), "mtf": np.array([1.0, 0.4])}
    return {
        "reason": None,
        "source": "scene.image",
        "picture": "back.image",
        "silenced": [],
        "interval_mrad": {"horizontal": 1.0, "vertical": 1.5},
        "stages": {"horizontal": stages, "vertical": stages},
        "measurements": list(measurements),
    }


def test_a_row_names_direction_and_edge_before_its_figures():
    given = facts_of(
        measurement("horizontal", "slanted_edge"),
        measurement("vertical", "row_average", mtf50=0.75, nyquist=1.5),
    )
    blocks = judged({"judged": given, "drawn_as": {}})
    (grid,) = [block for block in blocks if isinstance(block, Grid)]
    assert [tuple(map(str, row)) for row in grid.rows] == [
        ("horizontal", "slanted edge", "1.25 ± 0.02", "1.75", "0.125", "0.25", "−0.064", "2"),
        ("vertical", "row average", "0.75 ± 0.02", "1.25", "0.125", "0.25", "−0.064", "1.5"),
    ]
