"""Steps that the library does not know, written here as a module of one's own would be."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from app.report.edge_measurement import edge_row
from core.chain.engine import Engine
from core.chain.frame_sequence import at_frame
from core.chain.random_fields import Stream, normal_field
from core.chain.step_lineage import Linear, picture_step, source_step
from core.chain.wires import Image
from core.evaluation.recipes import Step
from core.evaluation.work import Policy
from nodes.analysis.lineage import NoiseOf, noise_free, transfer_of
from nodes.library import standard_library

ROWS, COLUMNS = 24, 40
SEEN = np.linspace(2.0, 6.0, ROWS * COLUMNS).reshape(ROWS, COLUMNS)


@source_step(area_means=True)
def seen(work):
    return SEEN


def _shot(at, image, deviates, *, electrons):
    return [at.white("shot", at.work.value(image) / electrons)]


@picture_step(noise=_shot, looks_at=("image",))
def with_shot_noise(work, image, deviates, *, electrons):
    return image + deviates * np.sqrt(image / electrons)


def deviates(work, *, stream):
    return normal_field(stream, (ROWS, COLUMNS), dtype=np.float64, for_each=work.for_each)


@dataclass(frozen=True)
class Attenuation(Linear):
    share: float

    @property
    def gain(self):
        return self.share

    def noise(self, work, power):
        return power.scaled(self.share)

    def row(self, work, row, axis):
        return self.share * row


def _attenuation(other, image, *, share):
    return Attenuation(share)


@picture_step(picture="image", linear=_attenuation)
def attenuated(work, other, image, *, share):
    return share * image


def chain(share=0.5):
    """A scene, noise of 100 electrons a unit, and half of it all; the picture comes second."""
    scene = Step.of(seen)
    drawn = Step.of(deviates, stream=Stream(1996, "here", "shot"))
    noisy = Step.of(with_shot_noise, scene, drawn, node="shot", electrons=100.0)
    dimmed = Step.of(attenuated, Step.of(seen), noisy, node="dim", share=share)
    return scene, Image(dimmed, ROWS, COLUMNS, 0.1, 0.1)


@pytest.fixture
def work():
    return Engine(standard_library()).work(Policy(precision="double"))


def test_its_noise_arrives(work):
    """Var = N/electrons, times the share squared; so much do 400 frames show of it."""
    _, image = chain()
    found = work.value(NoiseOf(image))
    assert [(term.node, term.name, term.temporal) for term in found.terms] == [
        ("shot", "shot", True)
    ]
    true = 0.25 * SEEN.mean() / 100.0
    assert found.total.total == pytest.approx(true, rel=1e-12)
    frames = [work.value(at_frame(image.recipe, frame)) for frame in range(400)]
    variance = np.var(frames, axis=0, ddof=1).mean()
    assert variance == pytest.approx(true, rel=4 * np.sqrt(2 / (400 * SEEN.size)))


def test_its_gain_and_its_source():
    scene, image = chain()
    passed = transfer_of(image)
    assert passed.source.key == scene.key
    assert (passed.gain, passed.stages, passed.area_means) == (0.5, (), True)


def test_a_row_of_an_edge(work):
    scene, image = chain()
    quiet = noise_free(image.recipe)
    np.testing.assert_array_equal(edge_row(work, quiet, scene, "x", 4), [0.0, 0.0, 0.5, 0.5])


def test_noise_and_a_blur_are_two_steps():
    def both(work, other, image, *, share):
        return share * image

    marked = picture_step(picture="image", linear=_attenuation, noise=_shot)(both)
    _, image = chain()
    step = replace(image.recipe, function=marked)
    with pytest.raises(ValueError, match="split it into two steps"):
        _ = step.lineage
