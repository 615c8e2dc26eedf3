"""Read-out artefacts against charges that are moved one transfer, or one spill, at a time."""

import numpy as np
import pytest

from core.physics.detector.readout import (
    bloomed,
    persistence,
    smear,
    smear_mtf,
    trail_length,
    trailed,
)


def frames_transferred(light, ratio):
    """The second frame of a frame-transfer CCD whose storage lies below: shift, wait, expose."""
    image = np.zeros_like(light)
    for _ in range(2):
        image = image + light
        storage = np.zeros_like(light)
        for shift in range(len(light)):
            storage = np.vstack([image[-1:], storage[:-1]])
            image = np.vstack([np.zeros_like(image[:1]), image[:-1]])
            if shift < len(light) - 1:  # the exposure follows the last shift at once
                image = image + ratio * light
    return storage


def test_smear_is_what_packets_collect_on_their_way():
    light = np.random.default_rng(3).random((12, 4))
    expected = frames_transferred(light, 0.01)
    total = light.sum(axis=0)
    for split in (0, 5):
        how = {"total": total, "ratio": 0.01, "above": True, "below": True}
        parts = [
            smear(charge=light[:split], passed=0.0 * total, **how),
            smear(charge=light[split:], passed=light[:split].sum(axis=0), **how),
        ]
        np.testing.assert_allclose(light + np.concatenate(parts), expected, rtol=0, atol=1e-14)


def test_the_contrast_behind_smear_is_the_mean_over_the_rows():
    rows, ratio, frequency = 9, 0.03, np.array([0.0, 0.04, 0.21, 0.5])
    waves = np.exp(2j * np.pi * np.outer(np.arange(rows), frequency))
    added = ratio * (waves.sum(axis=0) - waves)
    found = ((waves + added) / waves).mean(axis=0).real / (1 + ratio * (rows - 1))
    mtf = smear_mtf(frequency=frequency / 0.1, interval_mrad=0.1, rows=rows, ratio=ratio, sides=2)
    np.testing.assert_allclose(mtf, found, rtol=1e-13)


def spilled(charge, well):
    """Every full pixel passes half of its excess to either side, until there is none left."""
    charge, lost = np.array(charge, float), 0.0
    while (excess := np.maximum(charge - well, 0.0)).max() > 1e-12:
        charge -= excess
        charge[1:] += excess[:-1] / 2
        charge[:-1] += excess[1:] / 2
        lost += (excess[0] + excess[-1]) / 2
    return charge, lost


@pytest.mark.parametrize(
    "charge",
    [
        [0, 0.5, 9, 0.2, 0, 0, 0, 0, 0, 0, 0, 0],
        [0, 0, 3, 0.9, 0.9, 3, 0, 0],
        np.random.default_rng(5).exponential(0.45, 60),
        [7],
    ],
)
def test_blooming_is_where_spills_end_and_loses_nothing_on_the_way(charge):
    expected, lost = spilled(charge, 1.0)
    found = bloomed(charge=charge, full_well=1.0)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10)
    assert found.max() == 1.0
    assert np.sum(charge) - found.sum() == pytest.approx(lost, abs=1e-10)
    np.testing.assert_allclose(
        bloomed(charge=charge[::-1], full_well=1.0)[::-1], found, rtol=0, atol=1e-12
    )


def test_blooming_by_hand():
    spread = bloomed(charge=[0, 0, 3, 0, 0.25, 0.5], full_well=1.0)
    np.testing.assert_allclose(spread, [0, 1, 1, 1, 0.25, 0.5], rtol=0, atol=1e-15)
    drained = bloomed(charge=[0.1, 0, 3, 0, 0.25, 0.5], full_well=1.0, drained=0.75)
    np.testing.assert_allclose(drained, [0.1, 0.25, 1, 0.25, 0.25, 0.5], rtol=0, atol=1e-15)
    untouched = np.random.default_rng(1).random(30)
    np.testing.assert_array_equal(bloomed(charge=untouched, full_well=1.0), untouched)


def register_read(charge, efficiency, nearest):
    """A register clocked pixel by pixel; what stays behind joins the next packet."""
    register = np.concatenate([np.zeros((nearest, charge.shape[1])), charge])
    read = []
    for _ in register:
        moved, register = efficiency * register, (1 - efficiency) * register
        read.append(moved[0])
        register[:-1] += moved[1:]
    return np.array(read)[nearest:]


@pytest.mark.parametrize(
    ("efficiency", "nearest", "pixels"),
    [(0.999, 0, 200), (0.98, 7, 150), (0.5, 0, 50), (0.99999, 300, 90), (1.0, 2, 9)],
)
def test_trails_are_those_of_a_register_clocked_pixel_by_pixel(efficiency, nearest, pixels):
    charge = np.random.default_rng(4).random((pixels, 2))
    length = trail_length(transfers=pixels + nearest, efficiency=efficiency)
    found = trailed(charge=charge, efficiency=efficiency, length=length, nearest=nearest)
    np.testing.assert_allclose(
        found, register_read(charge, efficiency, nearest), rtol=0, atol=5e-13
    )
    start = min(40, pixels // 2)
    skip = min(length, start)
    part = trailed(
        charge=charge[start - skip :],
        efficiency=efficiency,
        length=length,
        nearest=nearest + start - skip,
        skip=skip,
    )
    np.testing.assert_array_equal(part, found[start:])


def test_lag_by_hand():
    left = persistence(
        shares=(0.02, 0.01), time_constants_s=(1 / np.log(2), 3 / np.log(2)), delay_s=3
    )
    assert left == pytest.approx(0.02 / 8 + 0.01 / 2, rel=1e-14)
