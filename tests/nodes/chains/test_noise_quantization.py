"""Quantization: its error, its range, and pictures without one."""

from __future__ import annotations

import numpy as np
import pytest

from core.errors import InputError
from noise_bench import QUIET, network, rms


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("bits", [4, 5, 8])
@pytest.mark.parametrize("given_range", [{}, {"range_low": -3.0, "range_high": 13.0}])
def test_quantization_error_of_a_ramp(bench, bits, given_range, precision):
    picture = np.linspace(0, 10, 128 * 256).reshape(128, 256)
    bench.picture(picture)
    document = network({**QUIET, "bits": bits, **given_range})
    image, error = bench.get(document, "noise.image", "noise.quantization_error",
                             precision=precision)  # fmt: skip
    low, high = given_range.get("range_low", 0.0), given_range.get("range_high", 10.0)
    q = (high - low) / (2**bits - 1)
    # A ramp fills the steps evenly but for the two at its ends.
    assert rms(error) == pytest.approx(q / np.sqrt(12), rel=0.02)
    assert np.abs(error).max() <= q / 2 * (1 + 1e-4)
    assert len(np.unique(image)) <= 2**bits
    if not given_range:
        assert len(np.unique(image)) == 2**bits
    levels = (image.astype(float) - low) / q
    assert np.abs(levels - np.rint(levels)).max() <= 1e-4
    if precision == "double":
        assert bench.readouts(document)["quantization_rms"] == pytest.approx(rms(error), rel=1e-9)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("bits", [24, 32, 64])
def test_many_bits_change_nothing_beyond_rounding(bench, bits, precision):
    picture = np.random.default_rng(0).uniform(-3, 10, (20, 30))
    bench.picture(picture)
    image = bench.get(network({**QUIET, "bits": bits}), "noise.image", precision=precision)
    rounding = {"single": 2e-7, "double": 1e-15}[precision] * 13 + 13 / 2.0**bits
    assert np.abs(image - picture).max() <= rounding + 1e-9  # what the quiet detector adds


@pytest.mark.parametrize("ends", [{"range_low": 20.0}, {"range_high": -4.0}])
def test_a_picture_beyond_the_one_end_given_is_clipped_or_refused(bench, ends):
    """Every sample lies outside: what comes out is that end, never the picture as it was."""
    bench.picture(np.linspace(0, 10, 30).reshape(5, 6))
    try:
        image = bench.get(network({**QUIET, "bits": 8, **ends}), "noise.image")
    except InputError:
        return
    assert np.all(image >= ends.get("range_low", -np.inf))
    assert np.all(image <= ends.get("range_high", np.inf))
