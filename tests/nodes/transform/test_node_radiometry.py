"""To Radiance and To Temperature: Planck's integral by mpmath, each other's inverse, refusals."""

import mpmath
import numpy as np
import pytest

from core.errors import DataError
from linked_network import in_order
from node_bench import NodeBench
from nodes.analysis.lineage import NoiseOf, transfer_of

BAND = {"cut_on_um": 8.0, "cut_off_um": 12.0}
FOV = {"fov_x_deg": 1.0, "fov_y_deg": 1.0}
KELVIN = np.array([[250.0, 288.15, 300.0], [310.5, 400.0, 1000.0]])


def planck(kelvin, low=8, high=12):
    """∫ 2hc²/λ⁵/(e^{hc/λkT} − 1) dλ, W/m²/sr, constants of 2019's SI."""
    h, c = mpmath.mpf("6.62607015e-34"), mpmath.mpf(299792458)
    k = mpmath.mpf("1.380649e-23")

    def spectral(wave):
        return 2 * h * c**2 / wave**5 / mpmath.expm1(h * c / (wave * k * mpmath.mpf(kelvin)))

    ends = [mpmath.mpf(place) * 1e-6 for place in np.linspace(low, high, 5)]
    return float(mpmath.quad(spectral, ends))


@pytest.fixture
def chain(tmp_path):
    def made(samples, read, *nodes, emissivity=None, precision="double"):
        np.save(tmp_path / "in.npy", samples)
        table = {"read": ("read_image", {"path": "in.npy", **FOV, **read})}
        table |= {f"n{number}": node for number, node in enumerate(nodes)}
        links = in_order(table)
        if emissivity is not None:
            np.save(tmp_path / "share.npy", emissivity)
            table["share"] = ("read_image", {"path": "share.npy", "unit": "1"})
            links += [("share.image", f"n{n}.emissivity") for n in range(len(nodes))]
        bench = NodeBench(tmp_path, table, links, precision=precision)
        return bench, f"n{len(nodes) - 1}.image"

    return made


@pytest.mark.parametrize(
    ("unit", "samples"),
    [
        ("K", KELVIN), ("°C", KELVIN - 273.15), ("mK", KELVIN * 1e3),
        ("°F", (KELVIN - 273.15) * 1.8 + 32),
    ],
)  # fmt: skip
@pytest.mark.parametrize(("share", "around"), [(1.0, None), (0.85, 280.0), (0.6, None)])
def test_radiance_is_plancks(chain, unit, samples, share, around):
    params = {"emissivity": share, "surroundings_K": around}
    bench, last = chain(samples, {"unit": unit, **BAND}, ("to_radiance", params))
    assert bench.warnings() == []
    image = bench.port(last)
    assert (image.unit, image.band_um) == ("W/m²/sr", (8.0, 12.0))
    reflected = 0.0 if around is None else (1 - share) * planck(around)
    expected = [[share * planck(value) + reflected for value in row] for row in KELVIN]
    assert bench.value(last) == pytest.approx(np.array(expected), rel=1e-12)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("shares", [None, np.linspace(0.3, 1.0, 6).reshape(2, 3)])
def test_there_and_back(chain, precision, shares):
    """An image of emissivities counts for each sample; the two undo each other."""
    params = {"emissivity": 0.7, "surroundings_K": 240.0}
    bench, last = chain(
        KELVIN, {"unit": "K", **BAND}, ("to_radiance", params), ("to_temperature", params),
        emissivity=shares, precision=precision,
    )  # fmt: skip
    assert bench.plan.errors() == []
    limit = {"double": 1e-11, "single": 2e-6}[precision]
    assert bench.value(last) == pytest.approx(KELVIN, rel=limit)
    radiance = bench.value("n0.image")
    share = np.full(KELVIN.shape, 0.7) if shares is None else shares
    expected = share[1, 1] * planck(400) + (1 - share[1, 1]) * planck(240)
    assert radiance[1, 1] == pytest.approx(
        expected, rel={"double": 1e-12, "single": 1e-6}[precision]
    )


def test_radiance_in_other_units_and_a_band_typed_here(chain):
    samples = np.full((2, 2), planck(300, 3, 5) / 10)  # mW/cm²/sr is 10 W/m²/sr
    bench, last = chain(
        samples, {"unit": "mW/cm^2/sr"}, ("to_temperature", {"cut_on_um": 3, "cut_off_um": 5})
    )
    assert bench.plan.errors() == []
    assert bench.value(last) == pytest.approx(np.full((2, 2), 300.0), rel=1e-11)


@pytest.mark.parametrize(
    ("unit", "key", "words"),
    [
        ("W/m²/sr", "to_radiance", ("'W/m²/sr'", "already one of radiance")),
        ("DN", "to_radiance", ("'DN'", "not one of temperature", "K, °C, °F or mK")),
        ("", "to_radiance", ("the picture has no unit",)),
        ("K", "to_temperature", ("'K'", "already a temperature")),
        ("counts", "to_temperature", ("'counts'", "not the radiance of a band in watts")),
        ("", "to_temperature", ("without a unit", "not the radiance")),
        ("W/m²/sr/µm", "to_temperature", ("not the radiance of a band",)),
        ("photons/s/m²/sr", "to_temperature", ("not the radiance of a band in watts",)),
    ],
)
def test_no_unit_is_taken_for_another(chain, unit, key, words):
    read = {"unit": unit} if unit else {"unit": " "}
    bench, _ = chain(KELVIN, read, (key, {"cut_on_um": 8, "cut_off_um": 12}))
    (error,) = bench.plan.errors()
    assert error.node == "n0"
    for word in words:
        assert word in str(error)
    assert "\n" not in str(error)


@pytest.mark.parametrize(
    ("samples", "key", "unit", "params", "shares", "words"),
    [
        (-KELVIN, "to_radiance", "K", {}, None, "temperature_K"),
        (-KELVIN, "to_temperature", "W/m²/sr", {}, None, "temperature for 6 of 6 samples"),
        (KELVIN / 100, "to_temperature", "W/m²/sr", {"emissivity": 0.1, "surroundings_K": 300.0},
         None, "no brightness temperature"),
        (KELVIN, "to_radiance", "K", {}, KELVIN, "outside 0 to 1 in 6 of 6 samples"),
        (KELVIN, "to_temperature", "W/m²/sr", {}, np.zeros((2, 3)), "emissivity of 0"),
    ],
)  # fmt: skip
def test_samples_that_mean_nothing(chain, samples, key, unit, params, shares, words):
    bench, last = chain(samples, {"unit": unit, **BAND}, (key, params), emissivity=shares)
    assert bench.plan.errors() == []
    with pytest.raises(DataError if "temperature_K" not in words else Exception) as refused:
        bench.value(last)
    assert words in str(refused.value)


def test_noise_goes_by_the_slope_at_the_mean(chain):
    """Poisson noise of 300 K's radiance in kelvin: σ over dL/dT, by a difference of integrals."""
    radiance = planck(300)
    bench, last = chain(
        np.full((20, 30), radiance), {"unit": "W/m²/sr", **BAND},
        ("poisson_noise", {"mode": "photon", "photons_per_unit": 1e7}), ("to_temperature", {}),
    )  # fmt: skip
    slope = (planck(300.01) - planck(299.99)) / 0.02
    found = bench.work.value(NoiseOf(bench.port(last))).total.total
    near = 2e-5  # the slope is that at the mean of the noisy picture
    assert found == pytest.approx(radiance / 1e7 / slope**2, rel=near)
    drawn = np.var(bench.value(last).astype(float))
    assert drawn == pytest.approx(found, rel=6 * np.sqrt(2 / 600))
    passed = transfer_of(bench.port(last))
    (level,) = passed.levels
    assert bench.work.value(level).gain == pytest.approx(1 / slope, rel=near)
