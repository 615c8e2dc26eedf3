"""A measurement in words: figures to the digits of their errors, and what is missing."""

import math

import numpy as np
import pytest

from app.measure.measurement_text import figure_rows, remarks, with_error
from app.measure.measuring import MeasurePlan, measure_files
from edge_truth import gaussian_edge


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.187208, 0.000277855, "0.18721 ± 0.00028"),
        (1e-10, 0.0034, "0.0000 ± 0.0034"),
        (-1e-9, 0.01, "0.000 ± 0.010"),
        (5145.92, 23.48, "5146 ± 23"),
        (12345.6, 480.0, "12350 ± 480"),
        (1.0, 0.00996, "1.000 ± 0.010"),
        (3.2e-9, 1.1e-10, "3.2e-09 ± 1.1e-10"),
        (0.12345, None, "0.1235"),
        (0.5, math.inf, "0.5"),
        (3.0, 0.0, "3"),
        (None, 1.0, "–"),
    ],
)
def test_a_figure_has_the_digits_that_its_error_leaves(value, error, text):
    assert with_error(value, error) == text


def test_figures_of_flat_fields_are_told_from_the_pictures_own(tmp_path):
    """5 electrons a number from 100 on, 10 of read noise: levels of the picture and of flats."""
    random = np.random.default_rng(8)

    def numbers(electrons):
        read = 10.0 * random.standard_normal(electrons.shape)
        return np.rint((random.poisson(electrons) + read) / 5.0 + 100.0)

    edge = gaussian_edge(angle_deg=6.0, sigma=(0.6, 0.6), shape=(128, 128), levels=(2000, 20000))
    np.save(tmp_path / "edge.npy", numbers(edge))
    flats = []
    for level in (500.0, 4000.0, 9000.0, 15000.0, 22000.0):
        flats.append(tmp_path / f"{level:.0f}.npy")
        np.save(flats[-1], np.stack([numbers(np.full((128, 128), level)) for _ in range(4)]))
    np.save(tmp_path / "dark.npy", np.stack([numbers(np.zeros((128, 128))) for _ in range(4)]))
    alone = measure_files(MeasurePlan((tmp_path / "edge.npy",)))
    assert any("frames of flat fields" in line for line in remarks(alone))
    assert not any("alone" in meaning for *_, meaning in figure_rows(alone))
    beside = measure_files(
        MeasurePlan(
            (tmp_path / "edge.npy",), flats=tuple(flats), dark=tmp_path / "dark.npy"
        )
    )  # fmt: skip
    assert beside.flats.curve.gain_e_per_dn == pytest.approx(5.0, rel=0.05)
    assert not any("frames of flat fields" in line for line in remarks(beside))
    own = [meaning for name, *_, meaning in figure_rows(beside) if name in ("gain", "read_noise")]
    said = [line for line in remarks(beside) if "gain" in line or "read noise" in line]
    assert own or said
    assert all("from the picture alone" in meaning for meaning in own)
    assert all(line.startswith("from the picture alone, ") for line in said)
