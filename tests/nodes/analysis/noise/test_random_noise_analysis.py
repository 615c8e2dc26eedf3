"""Random noisy chains through every module that follows noise: figures, or a fault in words."""

from __future__ import annotations

from contextlib import suppress
from random import Random

import numpy as np
import pytest

from core.chain.engine import Engine
from core.errors import ImagechainError
from core.evaluation.policy import Policy
from core.modules.declaration import declaration
from drawn_modules import Item, Modules, Params, Sampling
from drawn_networks import Drawn, drawn, frames
from nodes.library import standard_library
from slow_comparison import network_of

LIBRARY = standard_library()
SIZES = [(1, 7), (2, 3), (5, 8), (11, 47), (48, 49), (53, 94)]
ANALYSES = ("noise_budget", "noise_3d", "figures_of_merit")


class Noisy(Modules):
    """With noise in every module that has some."""

    def electronics_noise(self, at: Sampling) -> Params:
        choice = self.random.choice
        params = super().electronics_noise(at)
        params |= {
            "d_star": choice((1e9, 1e11)),
            "amplifier_snr": choice((30.0, 300.0)),
            "gain_model": choice(("published", "per_pixel", "literal")),
            "noise_variability_percent": choice((0.0, 40.0)),
            "gain_percent": choice((0.0, 2.0)),
            "bias_percent": choice((0.0, 2.0)),
        }
        return params

    def anti_alias(self, _: Sampling) -> Item:
        """In its place photon noise: an anti-aliaser is drawn often enough elsewhere."""
        how: tuple[Params, ...] = ({"percent": 20.0}, {"mode": "photon", "photons_per_unit": 9.0})
        return Item("poisson_noise", self.random.choice(how))


def noisy(random: Random, names) -> Drawn:
    return drawn(random, names, most=5, modules=Noisy(random, names))


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    folder = tmp_path_factory.mktemp("frames")
    files = frames(SIZES)
    for name, samples in files.items():
        np.save(folder / name, samples)
    names = {s: [n for n in files if n.endswith(f"_{s[0]}x{s[1]}.npy")] for s in SIZES}
    return folder, {**names, ("pupil", 0): [n for n in files if n.startswith("pupil")]}


def analysed(network: Drawn, random: Random) -> dict:
    document = network.document()
    nodes, links = document["nodes"], document["links"]
    context = next((name for name in nodes if name.startswith("init")), "init")
    if context not in nodes:
        nodes[context] = {"module": "init_trans", "params": {"focal_length_mm": 50.0}}
        links.append(["file.image", f"{context}.image"])
    nodes[context]["params"]["platform"] = random.choice(("line", "push", "array"))
    for key in ANALYSES:
        nodes[key] = {"module": key, "params": {}}
        links.append([document["last"], f"{key}.image"])
    links.append([f"{context}.context", "figures_of_merit.context"])
    nodes["figures_of_merit"]["params"] = {
        "model": random.choice(("flir92", "ratches_1976")),
        "cut_on_um": 8.0, "cut_off_um": 12.0, "background_K": 300.0,
    }  # fmt: skip
    nodes["noise_3d"]["params"] = {"frames": random.choice((0, 0, 3))}
    return document


@pytest.mark.thorough(but=3)
@pytest.mark.parametrize("chunk", range(8))
def test_noise_is_told_or_refused_in_words(bench, chunk):
    folder, names = bench
    random, engine = Random(f"noisy chains {chunk}"), Engine(LIBRARY)
    told = 0
    for _ in range(6):
        document = analysed(noisy(random, names), random)
        plan = engine.plan(network_of(document), folder=folder)
        work = engine.work(Policy(precision="double"))
        for key in ANALYSES:
            with suppress(ImagechainError):
                for port in declaration(LIBRARY[key]).outputs:
                    engine.value(plan, f"{key}.{port.name}", work)
                told += 1
    assert told >= 6  # of 18: most of these frames and chains have figures
