"""What a picture has gone through."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from app.report.edge_measurement import edge_row
from core.chain.engine import Engine
from core.chain.random_fields import Stream, at_frame, normal_field
from core.chain.step_lineage import Linear, picture_step, source_step
from core.chain.wires import Image
from core.errors import DataError
from core.evaluation.recipes import Step
from core.evaluation.work import Policy
from node_bench import NodeBench, square_detectors
from nodes.analysis.lineage import Line, NoiseOf, noise_free, stage_along, transfer_of
from nodes.library import standard_library
from noisy_sensors import QUIET, noisy_sensor, picture_of

SIZE = 240


def chain_of(folder, picture, *, order=1):
    """Optics, detector, blocks of 3 × 2, read-out of a time constant, other numbers of samples."""
    np.save(folder / "in.npy", picture)
    fov = np.degrees(SIZE * 0.5 / 1000)
    lens = square_detectors(30.0, 20.0, 2.0, detector_y_um=20.0, edges="periodic")
    nodes = {
        "in": ("read_image", {"path": "in.npy", "fov_x_deg": fov, "fov_y_deg": fov}),
        "init": ("init_trans", lens),
        "blur": ("gaussian_mtf", {"sigma_x_mrad": 0.9, "sigma_y_mrad": 0.5}),
        "detector": ("detector_mtf", {}),
        "back": ("back_transform", {}),
        "pixels": ("combine_pixels", {"factor_x": 3, "factor_y": 2}),
        "read": ("electronics_noise", {**QUIET, "time_constant_s": 0.03}),
        "out": ("interpolate", {"width": 200, "height": 100, "order": order}),
    }
    bench = NodeBench(folder, nodes)
    assert not bench.plan.errors(), bench.plan.errors()
    return bench.port("out.image"), bench.work


@pytest.mark.parametrize("order", [0, 1, 3])
@pytest.mark.parametrize(("axis", "waves"), [("x", 4), ("x", 17), ("y", 3), ("y", 21)])
def test_total_is_what_becomes_of_a_wave(tmp_path, axis, waves, order):
    """Amplitude of the wave in the last picture over that in the first, phases included."""
    number = np.arange(SIZE)
    wave = np.cos(2 * np.pi * waves * (number + 0.5) / SIZE)
    picture = 40.0 + 10.0 * (wave[np.newaxis, :] if axis == "x" else wave[:, np.newaxis])
    image, work = chain_of(tmp_path, np.broadcast_to(picture, (SIZE, SIZE)), order=order)
    made = work.value(image.recipe)
    if axis == "y":
        made = made.T
    size = made.shape[1]
    places = (np.arange(size) + 0.5) / size
    amplitude = 2 * np.mean((made - made.mean()) @ np.exp(-2j * np.pi * waves * places)) / size
    # Interpolation makes other waves of it, none of which falls on it here. Across, the read-out
    # moves the wave, and the clamped edges of two or three samples in 200 do not go on with it.
    found = transfer_of(image)
    frequency = np.array([waves / (SIZE * 0.5)])
    line = Line("", 1.0, 0.0) if axis == "x" else Line("", 0.0, 1.0)
    mtf, ptf = 1.0, 0.0
    for stage in found.part("mtf"):
        mtf = mtf * stage_along(work, stage, "mtf", line, frequency)[0]
    for stage in found.part("ptf"):
        ptf = ptf + stage_along(work, stage, "ptf", line, frequency)[0]
    expected = 10.0 * mtf * np.exp(1j * ptf)
    assert amplitude == pytest.approx(expected, rel=1e-10)


def test_stages_and_sampling(tmp_path):
    image, _ = chain_of(tmp_path, np.random.default_rng(1).uniform(20, 60, (SIZE, SIZE)))
    found = transfer_of(image)
    assert [stage.label for stage in found.stages] == [
        "Gaussian MTF",
        "Detector MTF",
        "Combined pixels",
        "Electronics",
        "Interpolation",
    ]
    assert found.grid.shape == (100, 200)
    assert found.source_grid.shape == (SIZE, SIZE)
    assert found.source_grid.interval_x_mrad == pytest.approx(0.5)
    assert len(found.part("ptf")) == 1


def test_a_picture_without_interval_is_refused(tmp_path):
    np.save(tmp_path / "in.npy", np.ones((4, 5)))
    bench = NodeBench(tmp_path, {"in": ("read_image", {"path": "in.npy"})})
    with pytest.raises(DataError, match="sampling interval"):
        transfer_of(bench.port("in.image"))


def test_noise_on_the_way_changes_nothing(tmp_path):
    quiet, _ = picture_of(*noisy_sensor(tmp_path), tmp_path, 1)
    loud, _ = picture_of(
        *noisy_sensor(tmp_path, "photons", "gain", "amplifier", "quantization", "periodic"),
        tmp_path,
        1,
    )
    a, b = (tuple(f.key for f in transfer_of(image).factors) for image in (quiet, loud))
    assert a == b


def test_what_a_block_crops_moves_no_interval(tmp_path):
    """100 samples of 0.5 mrad become 101, of which blocks of two leave one over."""
    np.save(tmp_path / "in.npy", np.ones((100, 100)))
    fov = np.degrees(100 * 0.5 / 1000)
    nodes = {
        "in": ("read_image", {"path": "in.npy", "fov_x_deg": fov, "fov_y_deg": fov}),
        "more": ("interpolate", {"width": 101}),
        "pixels": ("combine_pixels", {"factor_x": 2}),
    }
    found = transfer_of(NodeBench(tmp_path, nodes).port("pixels.image"))
    assert [stage.label for stage in found.stages] == ["Interpolation", "Combined pixels"]
    assert found.source_grid.shape == (100, 100)
    assert found.source_grid.interval_x_mrad == pytest.approx(0.5, rel=1e-12)


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
