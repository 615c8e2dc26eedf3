"""The one MRTD of both directions: powers in closed form, and curves of any shape."""

from __future__ import annotations

import math

import numpy as np
import pytest

from core.physics.acquisition.mrtd import mrtd_two_dimensional

FREQUENCY = np.linspace(0.01, 3.9, 80)


class TestTwoDimensional:
    def test_equal_curves_are_their_own(self):
        curve = 0.1 * FREQUENCY**1.5
        frequency, mrtd = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=curve, vertical_K=curve
        )
        np.testing.assert_allclose(mrtd, 0.1 * frequency**1.5, rtol=1e-12)
        assert frequency[[0, -1]] == pytest.approx(FREQUENCY[[0, -1]])

    def test_root_of_both_frequencies(self):
        """Powers: f_h = T and f_v = √(T/2), so that f = T^(3/4)/2^(1/4)."""
        frequency, mrtd = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=FREQUENCY, vertical_K=2 * FREQUENCY**2
        )
        inside = (mrtd > 2 * 0.01**2) & (mrtd < 3.9)
        truth = mrtd**0.75 / 2**0.25
        np.testing.assert_allclose(frequency[inside], truth[inside], rtol=1e-9)

    def test_direction_that_ends_at_nyquist_stays_there(self):
        cut = np.where(FREQUENCY < 1, FREQUENCY, np.inf)
        frequency, mrtd = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=FREQUENCY, vertical_K=cut
        )
        last = FREQUENCY[FREQUENCY < 1][-1]
        assert frequency[-1] == pytest.approx(math.sqrt(FREQUENCY[-1] * last))
        assert mrtd[-1] == pytest.approx(FREQUENCY[-1])

    def test_nothing_resolved(self):
        found = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=FREQUENCY, vertical_K=np.full(80, np.inf)
        )
        assert [len(each) for each in found] == [0, 0]

    def test_without_noise_all_is_resolved_up_to_the_end(self):
        """One direction without noise is always at its end; both have an MRTD of zero to theirs."""
        nothing, cut = np.zeros(80), np.where(FREQUENCY < 1, 0.0, np.inf)
        frequency, mrtd = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=FREQUENCY, vertical_K=nothing
        )
        np.testing.assert_allclose(frequency, np.sqrt(mrtd * 3.9), rtol=1e-12)
        frequency, mrtd = mrtd_two_dimensional(
            frequency=FREQUENCY, horizontal_K=nothing, vertical_K=cut
        )
        end = FREQUENCY[FREQUENCY < 1][-1]
        assert frequency == pytest.approx([0.01, math.sqrt(3.9 * end)])
        assert list(mrtd) == [0, 0]

    @pytest.mark.parametrize(
        "curve",
        [
            FREQUENCY * np.exp(-FREQUENCY),  # boosted: it falls towards the end
            np.minimum(FREQUENCY, 1.0),  # level
            np.where(FREQUENCY < 0.02, FREQUENCY, np.inf),  # a single sample
            np.sin(5 * FREQUENCY) + 1.1,
        ],
    )
    def test_frequency_rises_whatever_the_curves(self, curve):
        for other in (curve, FREQUENCY, np.full(80, 0.3)):
            frequency, mrtd = mrtd_two_dimensional(
                frequency=FREQUENCY, horizontal_K=curve, vertical_K=other
            )
            assert len(frequency) == len(mrtd) > 0
            assert (np.diff(frequency) > 0).all()
            assert (np.diff(mrtd) > 0).all()
