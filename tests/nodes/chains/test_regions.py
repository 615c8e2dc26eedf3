"""A region of a picture is the whole picture's, to the bit, and costs less."""

from random import Random

import numpy as np
import pytest

from analytic_stages import CHAINS
from core.chain.engine import Engine
from core.chain.random_fields import BLOCK
from core.chain.skipped import skips
from core.evaluation.recipes import Region, Store
from core.evaluation.work import Policy, Work
from delivered_chains import chain_network, scene
from drawn_networks import SMALL, drawn, frames
from noise_bench import FULL, NOISY, network
from region_checks import LIBRARY, assert_parts, image_ports
from small_networks import SHIPPED, small_network
from thorough import examples

NAMES = sorted(path.stem for path in SHIPPED.glob("*.json"))
PRECISIONS = ["single", "double"]


@pytest.mark.thorough(but=len(NAMES))
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("size", "edges", "precision"),
    [((72, 96), "reflect", "single"), ((61, 75), "periodic", "double")],
    ids=str,
)
def test_shipped_networks(name, size, edges, precision):
    document = small_network(name, *size, edges)
    ports = image_ports(Engine(LIBRARY).plan(document, folder=SHIPPED))
    assert ports
    assert_parts(document, ports, SHIPPED, precision=precision)


@pytest.mark.thorough(but=27)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("chain", ["whole chain", "symmetric", "optics and delay"])
@pytest.mark.parametrize(
    ("size", "factors"),
    [((31, 17), (1, 1)), ((24, 60), (2, 3)), ((24, 60), (5, 7)), ((1, 9), (1, 1)), ((9, 1), (3, 1)),
     ((301, 270), (1, 1)), ((300, 270), (3, 2))],
    ids=str,
)  # fmt: skip
def test_delivered_and_combined(tmp_path, chain, edges, size, factors, precision):
    np.save(tmp_path / "in.npy", scene(*size))
    pixels = ("combine_pixels", {"factor_y": factors[0], "factor_x": factors[1], "mode": "sum"})
    document, last = chain_network(CHAINS[chain], *size, edges, [pixels])
    assert_parts(document, [f"{last}.image"], tmp_path, precision=precision)


@pytest.mark.thorough(but=7)
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("platform", ["line", "push", "array"])
@pytest.mark.parametrize(
    ("model", "given_range"),
    [("per_pixel", {"range_low": 30, "range_high": 50}), ("published", {}), ("literal", {})],
)
def test_noise(tmp_path, platform, given_range, model, precision):
    np.save(tmp_path / "in.npy", np.random.default_rng(1).uniform(20, 60, (301, 529)))
    document = network(
        {**FULL, **given_range, "gain_model": model},
        photons={"percent": 30, "width_px": 3},
        sensor={"platform": platform},
    )
    ports = [port for port in image_ports(Engine(LIBRARY).plan(document, folder=tmp_path))
             if not port.startswith(("file", "beside"))]  # fmt: skip
    assert len(ports) == 6

    def where(rows, columns):
        return [Region(0, 0, 1, 1), Region(200, 7, 1, 300), Region(5, 5, 30, 1),
                Region(240, 100, 30, 50)]  # fmt: skip

    assert_parts(document, ports, tmp_path, precision=precision, where=where, threads=2)


@pytest.mark.thorough(but=15)
@pytest.mark.parametrize("order", [0, 1, 3])
@pytest.mark.parametrize(
    ("width", "height"), [(40, 31), (17, 60), (50, 90), (5, 4), (1, 1), (17, None), (None, 80)]
)
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
def test_interpolated(tmp_path, order, width, height, edges):
    np.save(tmp_path / "in.npy", scene(31, 17))
    resize = ("interpolate", {"width": width, "height": height, "order": order})
    document, last = chain_network(("blur",), 31, 17, edges, [resize])
    for precision in PRECISIONS:
        assert_parts(document, [f"{last}.image"], tmp_path, precision=precision)


@pytest.mark.parametrize("precision", PRECISIONS)
def test_random_networks(tmp_path, precision):
    _, names = frames(tmp_path, SMALL[4:])
    random = Random(f"regions {precision}")
    for _ in range(examples(30)):
        network = drawn(random, names).network()
        ports = image_ports(Engine(LIBRARY).plan(network, folder=tmp_path))
        assert_parts(network, ports, tmp_path, precision=precision)


class Counted(Work):
    """Work that counts the items of its loops and the samples it keeps, by node."""

    def __init__(self):
        super().__init__(Policy(threads=1), Store())
        self.items = 0
        self.samples = {}

    def for_each(self, function, items):
        self.items += len(items)
        super().for_each(function, items)

    def _compute(self, recipe, region=None):
        value = super()._compute(recipe, region)
        if isinstance(value, np.ndarray):
            self.samples[recipe.node] = self.samples.get(recipe.node, 0) + value.size
        return value


def made(document, folder, port, region=None):
    work = Counted()
    Engine(LIBRARY).value(Engine(LIBRARY).plan(document, folder=folder), port, work, region)
    return work


class TestCost:
    ROWS, COLUMNS = 320, BLOCK // 64  # 64 rows a block of deviates

    def sensor(self, tmp_path, **params):
        picture = np.random.default_rng(1).uniform(20, 60, (self.ROWS, self.COLUMNS))
        np.save(tmp_path / "in.npy", picture.astype(np.float32))
        return network({**NOISY, **params}, sensor={"platform": "array"})

    def test_only_the_blocks_of_deviates_that_it_lies_in(self, tmp_path):
        document = self.sensor(tmp_path)
        assert made(document, tmp_path, "noise.detector_noise").items == 5
        assert made(document, tmp_path, "noise.detector_noise", Region(70, 9, 50, 9)).items == 1
        assert made(document, tmp_path, "noise.detector_noise", Region(70, 9, 90, 9)).items == 2

    def test_no_samples_beside_it(self, tmp_path):
        ends = {"range_low": 0, "range_high": 99}
        document = self.sensor(tmp_path, amplifier_snr=9, gain_percent=1, bits=8, **ends)
        region = Region(70, 9, 20, 30)
        steps = 7  # detector's and amplifier's deviates, two patterns, detected, amplified, levels
        assert made(document, tmp_path, "noise.image", region).samples["noise"] == steps * 600
        whole = made(document, tmp_path, "noise.image").samples["noise"]
        assert whole == steps * self.ROWS * self.COLUMNS

    def test_a_range_of_its_own_takes_the_whole(self, tmp_path):
        document = self.sensor(tmp_path, bits=8)
        region = Region(70, 9, 20, 30)
        made_of = made(document, tmp_path, "noise.image", region)
        assert made_of.samples["noise"] == 2 * self.ROWS * self.COLUMNS + 600


def account(document, folder, port, *regions):
    engine = Engine(LIBRARY)
    plan = engine.plan(document, folder=folder)
    work = engine.work(Policy(threads=1))
    for region in regions:
        engine.value(plan, port, work, region)
    found = skips(plan, work)
    unseen = {f"{each.node}.{name}" for each in found for name in each.ports}
    assert port not in unseen
    return {each.node: each for each in found if each.kind == "region"}


class TestAccount:
    def chain(self, tmp_path, edges="reflect", tail=()):
        np.save(tmp_path / "in.npy", scene(20, 40))
        return chain_network(("blur",), 20, 40, edges, tail)

    def test_of_a_transform(self, tmp_path):
        region = Region(3, 5, 10, 4)
        for edges, share in (("reflect", 0.5 + 0.5 * 4 / 40), ("periodic", 0.5 + 0.5 * 10 / 20)):
            document, last = self.chain(tmp_path, edges)
            found = account(document, tmp_path, f"{last}.image", region)
            assert list(found) == ["back"]
            assert found["back"].share == pytest.approx(share)
            assert found["back"].text == (
                "4 × 10 of 40 × 20 samples were needed: 1 of 1 steps computed only the samples "
                "needed"
            )

    def test_of_steps_between(self, tmp_path):
        tail = [("periodic_noise", {"amplitude": 2}), ("poisson_noise", {"percent": 30})]
        document, last = self.chain(tmp_path, tail=tail)
        region = Region(3, 5, 10, 4)
        found = account(document, tmp_path, f"{last}.image", region)
        # The photons' means take the whole picture that they are added to.
        shares = {name: each.share for name, each in found.items()}
        assert shares == {"tail0": 1, last: pytest.approx((1 + 40 / 800) / 2)}
        found = account(document, tmp_path, "tail0.image", region, Region(0, 0, 1, 1))
        assert found["tail0"].share == pytest.approx((40 + 1) / 2 / 800)

    def test_nothing_of_what_was_there(self, tmp_path):
        document, last = self.chain(tmp_path)
        engine = Engine(LIBRARY)
        plan = engine.plan(document, folder=tmp_path)
        engine.value(plan, f"{last}.image", engine.work(Policy()))
        work = engine.work(Policy())
        engine.value(plan, f"{last}.image", work, Region(0, 0, 2, 2))
        found = {(each.node, each.kind) for each in skips(plan, work)}
        assert ("back", "unchanged") in found
        assert ("back", "region") not in found
        for kinds in ({"region"}, {"unchanged"}):  # a region, and once more
            work = Engine(LIBRARY, engine.store).work(Policy(precision="double"))
            engine.value(plan, f"{last}.image", work, Region(0, 0, 2, 2))
            found = {each.kind for each in skips(plan, work) if each.node == "back"}
            assert found & {"region", "unchanged"} == kinds
