"""Noise in chains: levels, photons, rounding and streams."""

from dataclasses import replace

import numpy as np
import pytest

from core.chain.engine import Engine
from core.errors import ImagechainError, InputError
from core.evaluation.recipes import Store
from noise_bench import BOUND, FULL, LIBRARY, NOISY, QUIET, assert_rms, network, rms


class TestDetectorAndAmplifier:
    def test_rms_is_the_readout(self, bench):
        bench.picture(np.full((200, 300), 40.0))
        ner = bench.readouts(network(NOISY))["ner"]
        area_cm2 = 30e-4 * 20e-4 * 0.9 * 0.8
        nep = np.sqrt(area_cm2 * 30000) / 1e9
        g_number = (1 + 4 * 2**2) / np.pi
        assert ner == pytest.approx(1e4 * nep * g_number / area_cm2, rel=1e-12)
        for seed in range(5):
            for precision in ("single", "double"):
                noise = bench.get(
                    network(NOISY, seed=seed), "noise.detector_noise", precision=precision
                ).astype(float)
                assert_rms(noise, ner)
                assert abs(noise.mean()) <= BOUND * ner / np.sqrt(noise.size)
                # Fourth moment of a normal deviate: 3σ⁴, standard error √(96/n)·σ⁴.
                kurtosis = np.mean(noise**4) / ner**4
                assert abs(kurtosis - 3) <= BOUND * np.sqrt(96 / noise.size)

    @pytest.mark.parametrize(("reference", "level"), [("mean", 35.0), ("contrast", 30.0)])
    @pytest.mark.parametrize("snr", [0.01, 12.5, 1e9])
    def test_amplifier_noise_is_reference_over_snr(self, bench, reference, level, snr):
        picture = np.full((100, 200), 20.0)
        picture[:, 100:] = 50.0
        bench.picture(picture)
        document = network({**QUIET, "amplifier_snr": snr, "snr_reference": reference})
        image, noise = bench.get(document, "noise.image", "noise.noise")
        assert_rms(noise, level / snr)
        assert np.allclose(image - picture, noise, atol=1e-11 * np.abs(image).max())

    def test_spread_of_noise_among_detectors(self, bench):
        rows, columns, spread = 400, 250, 0.2
        bench.picture(np.full((rows, columns), 40.0))
        document = network({**NOISY, "noise_variability_percent": 100 * spread},
                           sensor={"platform": "push"})  # fmt: skip
        ner = bench.readouts(document)["ner"]
        noise = bench.get(document, "noise.detector_noise")
        columns_rms = np.sqrt(np.mean(noise**2, axis=0)) / ner
        # Each column's rms varies by the spread, and by its own sampling error 1/√(2·rows).
        expected = np.hypot(spread, np.sqrt((1 + spread**2) / (2 * rows)))
        error = expected / np.sqrt(2 * columns)
        assert abs(np.std(columns_rms) - expected) <= BOUND * error
        assert abs(np.mean(columns_rms) - 1) <= BOUND * expected / np.sqrt(columns)

    @pytest.mark.parametrize("edges", ["periodic", "reflect"])
    def test_pre_amplifier_filters_the_detector_noise(self, bench, edges):
        rows, columns = 200, 300
        bench.picture(np.full((rows, columns), 40.0))
        document = network({**NOISY, "use_mtf": True}, sensor={"edges": edges})
        noise, white = bench.get(document, "noise.noise", "noise.detector_noise")
        velocity, interval = 8000.0, np.radians(3) * 1000 / columns
        tau = interval / velocity
        xi = np.fft.fftfreq(columns, interval)
        power = np.mean(1 / (1 + (2 * np.pi * tau * velocity * xi) ** 2))
        assert power < 0.5
        expected = rms(white) * np.sqrt(power)
        # Coloured noise has fewer independent samples: n·(Σ|H|²)²/(n·Σ|H|⁴).
        fewer = power**2 / np.mean(1 / (1 + (2 * np.pi * tau * velocity * xi) ** 2) ** 2)
        assert abs(rms(noise) - expected) <= BOUND * expected / np.sqrt(2 * noise.size * fewer)


# ---------------------------------------------------------------- gain and bias

SEEDS = range(400)


@pytest.mark.thorough(but=7)
@pytest.mark.parametrize("model", ["per_pixel", "published"])
@pytest.mark.parametrize("platform", ["line", "push", "array"])
@pytest.mark.parametrize(("gain", "bias"), [(4.0, 0.0), (0.0, 3.0), (4.0, 3.0)])
def test_spread_of_gain_and_bias(bench, platform, model, gain, bias):
    rows, columns, level = 3, 4, 50.0
    bench.picture(np.full((rows, columns), level))
    how = {**QUIET, "gain_percent": gain, "bias_percent": bias, "gain_model": model}
    seeds = SEEDS if platform == "line" else SEEDS[:120]
    errors = np.array([
        bench.get(network(how, seed=seed, sensor={"platform": platform}), "noise.noise")
        for seed in seeds
    ])  # fmt: skip
    expected = level * np.hypot(gain, bias) / 100
    quiet = 1e-9 * level
    if platform == "line":
        assert np.ptp(errors, axis=(1, 2)).max() <= quiet
        errors = errors[:, :1, :1]
    elif platform == "push":
        assert np.ptp(errors, axis=1).max() <= quiet
        assert np.ptp(errors, axis=2).min() > quiet
        errors = errors[:, :1, :]
    else:
        assert np.ptp(errors, axis=1).min() > quiet
        assert np.ptp(errors, axis=2).min() > quiet
    assert_rms(errors, expected)
    assert abs(errors.mean()) <= BOUND * expected / np.sqrt(errors.size)


@pytest.mark.parametrize("model", ["per_pixel", "published"])
def test_gain_scales_what_each_pixel_sees_or_the_mean(bench, model):
    picture = np.full((300, 200), 10.0)
    picture[:, 100:] = 90.0
    bench.picture(picture)
    how = {**QUIET, "gain_percent": 2, "gain_model": model}
    noise = bench.get(network(how, sensor={"platform": "array"}), "noise.noise")
    for side, level in ((noise[:, :100], 10.0), (noise[:, 100:], 90.0)):
        assert_rms(side, 0.02 * (level if model == "per_pixel" else 50.0))


def test_literal_equation_scales_the_picture(bench):
    picture = np.random.default_rng(0).uniform(20, 60, (9, 14))
    bench.picture(picture)
    how = {**QUIET, "gain_percent": 2, "bias_percent": 1, "gain_model": "literal"}
    image = bench.get(network(how), "noise.image")
    mean = picture.mean()
    assert np.allclose(image, picture * 0.02 * mean + 0.01 * mean, rtol=1e-9)


def assert_poisson(samples, mean):
    """Mean and variance of n Poisson deviates: standard errors √(λ/n) and √((λ + 2λ²)/n)."""
    n = samples.size
    assert abs(samples.mean() - mean) <= BOUND * np.sqrt(mean / n)
    assert abs(samples.var() - mean) <= BOUND * np.sqrt((mean + 2 * mean**2) / n)
    # The two agree with each other too (they are positively correlated).
    assert abs(samples.var() - samples.mean()) <= BOUND * np.sqrt(2) * mean / np.sqrt(n)


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("seed", [1])
class TestPoissonPanels:
    """Two panels of means 50 and 12.5 have variances like their means (Tantalo 1996, fig. 4.23)."""

    def panels(self, bench):
        picture = np.full((120, 160), 12.5)
        picture[:, 80:] = 50.0
        bench.picture(picture)
        return picture

    def test_published(self, bench, precision, seed):
        picture = self.panels(bench)
        document = network(QUIET, seed=seed, photons={"percent": 100})
        image, noise = bench.get(document, "photons.image", "photons.noise", precision=precision)
        noise = noise.astype(float)
        # Five weights' widths away from the step the local mean is that of the panel to 3e-7.
        assert_poisson(noise[:, : 80 - 25], 12.5)
        assert_poisson(noise[:, 80 + 25 :], 50.0)
        assert np.allclose(image, picture + noise, rtol=1e-6)

    @pytest.mark.parametrize("scale", [4e-3, 0.1, 1.0, 1e6])
    def test_photon_mean_is_kept_at_any_count(self, bench, precision, seed, scale):
        self.panels(bench)
        document = network(QUIET, seed=seed, photons={"mode": "photon", "photons_per_unit": scale})
        image = bench.get(document, "photons.image", precision=precision).astype(float)
        for side, level in ((image[:, :80], 12.5), (image[:, 80:], 50.0)):
            counts = side * scale
            assert np.abs(counts - np.rint(counts)).max() <= 3e-7 * counts.max()
            assert_poisson(counts, level * scale)


def test_no_light_no_photons(bench):
    bench.picture(np.zeros((5, 6)))
    for photons in ({"mode": "photon", "photons_per_unit": 3}, {"percent": 50}):
        assert np.all(bench.get(network(QUIET, photons=photons), "photons.image") == 0)


def test_negative_light_is_refused(bench):
    bench.picture(np.linspace(-1, 5, 30).reshape(5, 6))
    for photons in ({"mode": "photon", "photons_per_unit": 3}, {"percent": 50, "width_px": 0}):
        with pytest.raises(ImagechainError, match="below 0") as caught:
            bench.get(network(QUIET, photons=photons), "photons.image")
        assert caught.value.node == "photons"
        assert caught.value.exit_code == 2


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


OUTPUTS = ("image", "noise", "detector_noise", "quantization_error")

PHOTONS = {"percent": 30, "width_px": 3}
PORTS = (*tuple(f"noise.{output}" for output in OUTPUTS), "photons.image", "photons.noise")


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("platform", ["line", "push", "array"])
class TestRepeats:
    def make(self, bench, platform):
        # More samples than a block of the streams holds, so that threads share them.
        bench.picture(np.random.default_rng(1).uniform(20, 60, (301, 229)))
        return network(FULL, photons=PHOTONS, sensor={"platform": platform})

    def test_threads_store_and_order_do_not_matter(self, bench, platform, precision):
        document = self.make(bench, platform)
        first = dict(zip(PORTS, bench.get(document, *PORTS, precision=precision, threads=1),
                         strict=True))  # fmt: skip
        orders = [PORTS, PORTS[::-1], (*PORTS[3:], *PORTS[:3])]
        engines = [Engine(LIBRARY), Engine(LIBRARY), Engine(LIBRARY, Store(capacity_bytes=1))]
        for order, engine, threads in zip(orders, engines, (2, 1, 2), strict=True):
            for port in order:
                again = bench.get(
                    document, port, engine=engine, precision=precision, threads=threads
                )
                assert np.array_equal(again, first[port]), (port, threads)


class TestStreams:
    def both(self, bench, *documents, port="detector_noise", node="noise"):
        bench.picture(np.random.default_rng(1).uniform(20, 60, (20, 30)))
        return [bench.get(document, f"{node}.{port}", engine=Engine(LIBRARY))
                for document in documents]  # fmt: skip

    def test_noises_of_a_node_and_of_nodes_are_independent(self, bench):
        bench.picture(np.full((200, 300), 40.0))
        how = {"amplifier_snr": 10, "gain_percent": 3, "bias_percent": 3}
        how["noise_variability_percent"] = 3
        document = network({**NOISY, **how}, sensor={"platform": "array"})
        ports = ("noise.noise", "noise.detector_noise", "beside.detector_noise")
        total, detector, other = bench.get(document, *ports)
        for one in (total - detector, other):
            assert abs(np.corrcoef(one.ravel(), detector.ravel())[0, 1]) <= BOUND / np.sqrt(
                one.size
            )

    def test_names_and_seeds_change_the_noise(self, bench):
        renamed = network(NOISY, names=("noise", "other"))
        a, b, c = self.both(bench, network(NOISY), network(NOISY, seed=7), renamed)
        assert not np.array_equal(a, b)
        assert np.array_equal(a, c)  # another node's name is no matter
        d = self.both(bench, network(NOISY, names=("reader", "photons")), node="reader")[0]
        assert not np.array_equal(a, d)

    def test_typed_seed_gives_the_same_noise_under_any_name_and_network(self, bench):
        typed = {**NOISY, "seed_mode": "typed", "seed": 42}
        a, b = self.both(bench, network(typed), network(typed, seed=3))
        c = self.both(bench, network(typed), node="beside")[0]
        d, e = self.both(bench, network({**typed, "seed": 43}), network({**NOISY, "seed": 42}))
        assert np.array_equal(a, b)
        assert np.array_equal(a, c)
        assert not np.array_equal(a, d)
        assert not np.array_equal(a, e)

    def test_typed_poisson_seed(self, bench):
        def noisy(**how):
            return network(QUIET, photons={"mode": "photon", "photons_per_unit": 2, **how})

        typed = {"seed_mode": "typed", "seed": 5}
        a, b = self.both(bench, noisy(**typed), replace(noisy(**typed), seed=8), port="image",
                         node="photons")  # fmt: skip
        c, d = self.both(bench, noisy(), replace(noisy(), seed=8), port="image", node="photons")
        assert np.array_equal(a, b)
        assert not np.array_equal(c, d)
