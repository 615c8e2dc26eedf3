"""SiTF and NETD of frames that numpy has drawn, of bands that the trapezium rule has integrated."""

import math

import numpy as np
import pytest

from core.errors import DataError
from core.physics.measurement.photon_transfer import FlatFrames
from core.physics.measurement.thermal_response import ThermalField, filled, thermal_response
from core.physics.noise.noise_components import NoiseCube

BANDS = {
    "3–5 µm, photons": (3.0, 5.0, 4),
    "1.5–5 µm, photons": (1.5, 5.0, 4),
    "7.5–13.5 µm, watts": (7.5, 13.5, 5),
}


def band(kelvin, low, high, power):
    """Planck's law over a band, to a factor: λ⁻⁴ counts photons, λ⁻⁵ watts."""
    wavelength = np.linspace(low, high, 4001)
    spectral = wavelength**-power / np.expm1(14387.768775 / (wavelength * kelvin))
    return float(np.sum((spectral[1:] + spectral[:-1]) / 2) * (wavelength[1] - wavelength[0]))


def slope(kelvin, *limits):
    step = 1e-3
    return (band(kelvin + step, *limits) - band(kelvin - step, *limits)) / (2 * step)


def field(kelvin, frames):
    taken, cube = FlatFrames(*frames[0].shape), NoiseCube(*frames[0].shape)
    for frame in frames:
        taken.add(frame)
        cube.add(frame)
    return ThermalField(kelvin, taken.measured(), cube.measured())


def noisy(kelvin, mean, random, *, sigma=8.0, whole=0.0, count=24, shape=(16, 20)):
    return field(
        kelvin,
        [
            mean + sigma * random.standard_normal(shape) + whole * random.standard_normal()
            for _ in range(count)
        ],
    )


def quiet(kelvin, mean):
    """Noise of 1e-6 of a number, so that means are exact."""
    return noisy(kelvin, mean, np.random.default_rng(1), sigma=1e-6, count=2)


@pytest.mark.parametrize("name", BANDS)
@pytest.mark.parametrize(
    "kelvin",
    [(298.0, 302.0), (293.15, 303.15), (293.15, 298.15, 303.15), (283.0, 303.0, 323.0),
     (293.0, 313.0, 333.0, 353.0, 373.0)],
)  # fmt: skip
def test_the_slope_of_a_band_is_within_its_error(name, kelvin):
    """Without noise, what is left is that of a band, or of a chord: all of the stated error."""
    limits = BANDS[name]
    scale = 5000.0 / (band(kelvin[-1], *limits) - band(kelvin[0], *limits))
    found = thermal_response([quiet(at, 100 + scale * band(at, *limits)) for at in kelvin])
    for level in (*found.levels, found.middle):
        true = scale * slope(level.temperature_K, *limits)
        assert abs(level.sitf - true) < level.sitf_error
        assert level.sitf_error > 0
    span = kelvin[-1] - kelvin[0]
    largest = 3e-6 if len(kelvin) > 2 else 3e-5
    middle = found.middle
    assert middle.sitf_error == pytest.approx(largest * span**2 * middle.sitf, rel=0.01)


def test_planck_at_one_wavelength_is_found_again():
    """B = 3200 K, 4.496 µm; levels fall with temperature, as of a camera that shows hot dark."""
    kelvin = (280.0, 300.0, 320.0, 340.0)
    means = [9000 - 4e7 / math.expm1(3200 / at) for at in kelvin]
    found = thermal_response([quiet(at, m) for at, m in zip(kelvin, means, strict=True)])
    assert found.wavelength_um == pytest.approx(14387.768775 / 3200, rel=1e-5)
    assert found.departure_percent < 1e-4
    true = -4e7 * 3200 / 310**2 * math.exp(3200 / 310) / math.expm1(3200 / 310) ** 2
    assert found.middle.sitf == pytest.approx(true, rel=1e-6)
    assert found.middle.netd_K > 0


@pytest.mark.thorough(but=1)
@pytest.mark.parametrize("whole", [5.0, 0.0], ids=["whole frames drift", "still"])
def test_the_standard_errors_are_the_spread_of_measurements_made_anew(whole):
    """Of 120 measurements the spread is known to 1/√240 = 6.5 %; three times that is allowed."""
    limits, kelvin = BANDS["3–5 µm, photons"], (297.0, 298.0, 299.0)
    scale = 100 / slope(298.0, *limits)
    random = np.random.default_rng(4)
    made = [
        thermal_response(
            [noisy(at, scale * band(at, *limits), random, whole=whole) for at in kelvin]
        ).middle
        for _ in range(120)
    ]
    for value, error, true in (
        ("sitf", "sitf_error", 100.0), ("netd_K", "netd_error_K", 0.08),
    ):  # fmt: skip
        values = np.array([getattr(one, value) for one in made])
        stated = np.mean([getattr(one, error) for one in made])
        assert stated == pytest.approx(np.std(values, ddof=1), rel=0.2), value
        assert np.mean(values) == pytest.approx(true, abs=4 * stated / math.sqrt(120)), value


def test_components_in_kelvin():
    """Each kind of noise by itself, drawn to its exact deviation, over 40 numbers of a kelvin."""
    random = np.random.default_rng(9)
    count, rows, columns = 40, 60, 80
    shapes = {
        "tvh": (count, rows, columns), "vh": (1, rows, columns), "v": (1, rows, 1),
        "h": (1, 1, columns), "tv": (count, rows, 1), "th": (count, 1, columns),
    }  # fmt: skip
    sizes = {"tvh": 2.0, "vh": 1.5, "v": 3.0, "h": 2.5, "tv": 1.0, "th": 0.8}
    frames = sum(
        sizes[name] * random.standard_normal(shape) for name, shape in shapes.items()
    ) + np.zeros(shapes["tvh"])
    found = thermal_response([field(at, frames + 40 * at) for at in (295.0, 305.0)])
    level = found.levels[0]
    for name, size in sizes.items():
        # v and h are known to 1/√(2·60) = 9 %.
        many = math.prod(shapes[name]) - 1
        allowed = 4 / math.sqrt(2 * many) + 0.01
        assert level.components_K[name] == pytest.approx(size / 40, rel=allowed), name
    assert level.netd_K == pytest.approx(2 / 40, rel=0.01)
    assert level.temporal_K == pytest.approx(math.hypot(2, 1, 0.8) / 40, rel=0.05)


def test_bad_pixels_are_filled_by_the_nearest_good_one_of_their_row():
    frame = np.arange(20.0).reshape(4, 5)
    good = np.ones((4, 5), bool)
    assert np.array_equal(filled(frame, good), frame)
    for place in ((0, 0), (1, 2), (1, 3), (3, 4)):
        good[place] = False
    made = filled(frame, good)
    assert (made[0, 0], made[1, 2], made[1, 3], made[3, 4]) == (1, 6, 9, 18)
    assert np.array_equal(made[good], frame[good])
    good[:] = False
    with pytest.raises(DataError, match="every pixel responds differently"):
        filled(frame, good)
    good[2, 2] = True
    assert (filled(frame, good) == 12).all()


@pytest.mark.parametrize(
    ("levels", "words"),
    [
        ({300.0: 5.0}, "needs frames at two or more temperatures, not 1"),
        ({300.0: 5.0, 310.0: 5.0}, "must rise or fall steadily"),
        ({300.0: 500.0, 310.0: 400.0, 320.0: 700.0}, "must rise or fall steadily"),
    ],
)
def test_what_has_no_response(levels, words):
    fields = [quiet(at, mean) for at, mean in levels.items()]
    with pytest.raises(DataError, match=words):
        thermal_response([*fields, *fields])
