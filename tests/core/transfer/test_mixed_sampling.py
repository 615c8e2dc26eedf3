"""Frames whose columns are sampled unlike in flight: how many intervals a blend takes."""

import numpy as np
import pytest

from core.chain.band_stack import band_mean_otf
from core.errors import DataError
from core.evaluation.policy import Policy
from core.evaluation.store import Store
from core.evaluation.work import Work
from core.physics.optics.diffraction_otf import Aperture, diffraction_otf
from core.physics.optics.pupil_otf import defocused_disc_otf
from core.physics.sampling.platform_motion import line_intervals_mrad, view_angles_rad
from core.transfer.factors import Grid, Law, Planar
from core.transfer.mixed_sampling import filter_mixed
from core.transfer.product import Product
from core.transfer.scan_lines import ScanChain

SHAPE = (9, 14)
ANGLES = view_angles_rad(columns=14, interval_mrad=13.6, look_angle_rad=0.5)
INTERVALS = line_intervals_mrad(line_spacing_m=2.9e-3, altitude_m=1.0, view_angle_rad=ANGLES)
IMAGE = np.random.default_rng(1).random(SHAPE)


def filtered(law, symmetric=True, **how):
    factor = Planar(law, radial=True, symmetric=symmetric)
    chain = ScanChain(Product([factor]), Grid(*SHAPE, 13.6, 2.9), "reflect")
    work = Work(Policy(precision="double"), Store(1 << 20))
    how = {"method": "nodes", **how}
    return filter_mixed(work, IMAGE, chain=chain, intervals_mrad=INTERVALS, **how)


def diffraction(wavelength_um, defocus_waves=0.0):
    return Law.of(
        diffraction_otf,
        aperture=Aperture(2.0, 0.3, defocus_waves),
        cut_on_um=wavelength_um,
        cut_off_um=wavelength_um,
        weighting="uniform",
        temperature_K=300.0,
        wavelengths=1,
    )


def disc(w20_waves):
    return Law.of(defocused_disc_otf, diameter_mm=2.0, w20_waves=w20_waves, reference_um=10.0,
                  wavelengths_um=(10.0,), weights=(1.0,))  # fmt: skip


def bands(count, defocus_waves):
    laws = tuple(diffraction(w, defocus_waves) for w in np.linspace(4.0, 12.0, count).tolist())
    return Law.of(band_mean_otf, laws=laws, shares=np.full(count, 1.0 / count))


@pytest.mark.parametrize(
    ("law", "symmetric", "tolerance"),
    [(diffraction(5.0), False, 1e-3), (bands(3, 0.3), True, 1e-2), (bands(3, 0.3), True, 1e-3)],
)
def test_a_blend_takes_the_fewest_intervals(law, symmetric, tolerance):
    found = filtered(law, symmetric, tolerance=tolerance)
    same = filtered(law, symmetric, nodes=found.nodes)
    assert found.nodes > 1
    assert (found.nodes, found.response_error) == (same.nodes, same.response_error)
    np.testing.assert_array_equal(found.picture, same.picture)
    assert found.response_error <= tolerance
    for fewer in range(1, found.nodes):
        assert filtered(law, symmetric, nodes=fewer).response_error > tolerance


@pytest.mark.parametrize(
    ("law", "nodes"), [(bands(48, 0.3), None), (bands(48, 0.3), 2), (disc(-9000.0), 32)]
)
def test_a_blend_that_takes_too_long_to_judge_is_refused(monkeypatch, law, nodes):
    monkeypatch.setattr("core.transfer.mixed_sampling.MOST_TRIED", 1e7)
    with pytest.raises(DataError, match=r"between \d+ intervals .* terms.*: use .* defocus"):
        filtered(law, nodes=nodes)


def test_direct_sums_count_the_terms_of_each_frequency(monkeypatch):
    monkeypatch.setattr("core.transfer.mixed_sampling.MOST_EVALUATIONS", 1e7)
    filtered(bands(4, 0.3), method="direct")
    with pytest.raises(DataError, match=r"14 intervals on 126 frequencies of 1\d,\d{3} terms each"):
        filtered(bands(48, 0.3), method="direct")
