"""Noise is repeatable to the last bit, and each its own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.chain.engine import Engine
from core.evaluation.store import Store
from noise_bench import BOUND, LIBRARY, NOISY, QUIET, network

OUTPUTS = ("image", "noise", "detector_noise", "quantization_error")

FULL = {
    **NOISY, "amplifier_snr": 20, "gain_percent": 3, "bias_percent": 2, "use_mtf": True,
    "noise_variability_percent": 10, "post_filter": "lowpass", "post_corner_Hz": 20000, "bits": 8,
}  # fmt: skip
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

    def test_nodes_draw_independently(self, bench):
        bench.picture(np.full((200, 300), 40.0))
        one, two = bench.get(network(NOISY), "noise.detector_noise", "beside.detector_noise")
        correlation = np.corrcoef(one.ravel(), two.ravel())[0, 1]
        assert abs(correlation) <= BOUND / np.sqrt(one.size)

    def test_noises_of_one_node_are_independent(self, bench):
        bench.picture(np.full((200, 300), 40.0))
        how = {"amplifier_snr": 10, "gain_percent": 3, "bias_percent": 3}
        how["noise_variability_percent"] = 3
        document = network({**NOISY, **how}, sensor={"platform": "array"})
        total, detector = bench.get(document, "noise.noise", "noise.detector_noise")
        rest = total - detector
        assert abs(np.corrcoef(rest.ravel(), detector.ravel())[0, 1]) <= BOUND / np.sqrt(rest.size)

    def test_no_correlation_between_neighbours(self, bench):
        bench.picture(np.full((200, 300), 40.0))
        noise = bench.get(network(NOISY), "noise.detector_noise")
        for a, b in ((noise[1:], noise[:-1]), (noise[:, 1:], noise[:, :-1])):
            assert abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) <= BOUND / np.sqrt(a.size)

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
