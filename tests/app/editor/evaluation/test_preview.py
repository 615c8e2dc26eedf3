"""Networks with smaller pictures: near the full picture, and its radiometry kept."""

from itertools import count

import numpy as np
import pytest

from app.editor.evaluation.changes import SMALLEST, reduced_network
from app.editor.evaluation.evaluator import Evaluator
from app.editor.session import Session
from app.run.shipped import shipped_networks
from core.chain.engine import Engine
from core.editing.document import Document
from core.editing.operations import set_parameter
from core.evaluation.work import Policy
from core.network.file import load_network
from core.network.network import Network
from editor_queries import Samples, SlowCopy
from linked_network import linked_network
from nodes.library import standard_library
from scripted_drag import drag

# Noise is per sample of what it is added to, so that it is no less in fewer samples.
SILENT = {
    "poisson_noise": {"percent": 0.0},
    "electronics_noise": {
        "d_star": 1e30,
        "amplifier_snr": None,
        "gain_percent": 0.0,
        "bias_percent": 0.0,
        "bits": 0,
    },
}
DOUBLE = Policy(precision="double")


def silent(name, library):
    network = load_network(shipped_networks()[name], library=library)
    for node in network.nodes.values():
        for parameter, value in SILENT.get(node.module, {}).items():
            network = network.with_parameter(node.id, parameter, value)
    return network


def both(network, factor, library, policy=DOUBLE, **options):
    """A function of a port: the full picture and that of the reduced network."""
    engine = Engine(library)
    plan = engine.plan(network)
    small = reduced_network(plan, factor, **options)
    assert small is not None
    small_plan = engine.plan(small)
    assert not small_plan.errors()
    work = engine.work(policy)
    return lambda port: tuple(engine.value(each, port, work) for each in (plan, small_plan))


def means_of_blocks(picture, rows, columns):
    height, width = picture.shape[0] // rows, picture.shape[1] // columns
    cropped = picture[: rows * height, : columns * width]
    return cropped.reshape(rows, height, columns, width).mean(axis=(1, 3))


# Blocks are averaged before the chain instead of after it. What lies beyond the smaller picture's
# band is folded before it is filtered and not after: the less the chain passes of it, the larger
# the difference. Measured with noise off, of the range: at 2 and 4 at most these, with a tenth on.
@pytest.mark.parametrize(
    ("name", "port", "rms"),
    [("first_steps", "back.image", 0.0078), ("pushbroom_banding", "electronics.image", 0.0024)],
)
def test_shipped_networks_look_alike(library, name, port, rms):
    full, small = both(silent(name, library), 4, library)(port)
    binned = means_of_blocks(full, *small.shape)
    assert float(np.sqrt(np.mean((binned - small) ** 2))) < rms * np.ptp(binned)
    assert small.mean() == pytest.approx(full.mean(), rel=1e-6)


def test_pixels_combined_later_are_combined_less(library):
    picture = both(silent("kodak_kir310", library), 2, library)
    assert [each.shape for each in picture("pixels.image")] == [(512, 512)] * 2
    assert [each.shape for each in picture("frame_grabber.image")] == [(486, 512)] * 2
    assert [each.shape for each in picture("back.image")] == [(1024, 1024), (512, 512)]


@pytest.mark.parametrize("given", [{}, {"factor_x": 4.5, "factor_y": 4.5}])
def test_as_many_pixels_are_sampled_of_fewer_samples(library, given):
    """By the pitch or by a number: a camera's pixels stay what they are in a smaller picture."""
    network = of_scene(
        "dormitory",
        {
            "camera": ("camera", {"pitch_um": 12, "focal_length_mm": 10}),
            "init": ("init_trans", {}),
            "detector": ("detector_mtf", {}),
            "back": ("back_transform", {}),
            "pixels": ("sample_pixels", given),
        },
        width=256,
        height=256,
        fov_x_deg=18.0,
        fov_y_deg=18.0,
    )
    full, small = both(network, 2, library)("pixels.image")
    # 18° are 314 mrad: 261 pixels of 1.2 mrad, or 256 samples by 4.5.
    assert full.shape == small.shape == ((56, 56) if given else (261, 261))
    assert small.mean() == pytest.approx(full.mean(), rel=0.01)


def of_scene(kind, nodes, links=None, **params):
    scene = {"kind": kind, "width": 64, "height": 64, **params}
    return linked_network({"scene": ("test_scene", scene), **nodes}, links)


COPY = {"copy": ("interpolate", {})}


@pytest.mark.parametrize("kind", ["slanted_edge", "sine"])
def test_scenes_drawn_smaller_are_the_means_of_blocks(library, kind):
    full, small = both(of_scene(kind, COPY), 4, library)("copy.image")
    np.testing.assert_allclose(small, means_of_blocks(full, *small.shape), rtol=1e-12)


@pytest.mark.parametrize("kind", ["framing", "pushbroom"])
def test_a_camera_over_a_smaller_scene_has_larger_pixels(library, kind):
    """Of 1 m on the ground, in a scene of 0.5 m: each is the mean of its samples."""
    params = {"kind": kind, "altitude_m": 1000.0, "ground_interval_m": 0.5, "fov_x_deg": None}
    params |= {"pitch_x_um": 10.0, "focal_length_mm": 10.0, "columns": 48, "rows": 40}
    if kind == "pushbroom":
        params |= {"velocity_m_per_s": 100.0, "line_rate_Hz": 100.0}
    camera = {"camera": ("camera_geometry", params)}
    network = of_scene("slanted_edge", camera, width=128, height=128)
    full, small = both(network, 2, library)("camera.image")
    assert (full.shape, small.shape) == ((40, 48), (20, 24))
    assert np.ptp(small) > 0.0
    np.testing.assert_allclose(small, means_of_blocks(full, 20, 24), rtol=1e-12)


def test_a_scene_under_edit_is_drawn_smaller(library):
    """Drawn again at each edit, at full size it would leave nothing to gain.

    The dormitory's foliage is drawn coarser then: measured 0.7 % of the range, 0.01 % of the mean.
    """
    network = of_scene("dormitory", COPY, width=1024, height=1024)
    plan = Engine(library).plan(network)
    assert reduced_network(plan, 4).nodes["scene"].params["width"] == 1024
    edited = reduced_network(plan, 4, edited={"scene"})
    assert edited.nodes["scene"].params["width"] == 256
    full, small = both(network, 4, library, edited={"scene"})("copy.image")
    binned = means_of_blocks(full, *small.shape)
    assert float(np.sqrt(np.mean((binned - small) ** 2))) < 0.008 * np.ptp(binned)
    assert small.mean() == pytest.approx(full.mean(), rel=2e-4)


@pytest.mark.parametrize(
    "network",
    [
        Network(),
        of_scene("uniform", {}, width=4 * SMALLEST - 1),
        of_scene("uniform", {"noise": ("noise_file", {"path": "n.npy"})}),
    ],
)
def test_where_it_cannot_be_there_is_none(library, network, tmp_path):
    np.save(tmp_path / "n.npy", np.ones((64, 64)))
    plan = Engine(library).plan(network, folder=tmp_path)
    assert not plan.errors()
    assert reduced_network(plan, 4) is None


@pytest.fixture
def slow(qtbot):
    """Session and evaluator with a module that takes 0.26 s for the full picture."""
    session = Session({**standard_library(), "slow_copy": SlowCopy})
    evaluator = Evaluator(session)
    evaluator.ask("viewer", [Samples("slow.image")])
    network = of_scene(
        "two_panel",
        {"slow": ("slow_copy", {"ns_per_sample": 1000.0})},
        [("scene.image", "slow.image")],
        width=512,
        height=512,
    )
    session.open(Document(network, library=session.library))
    qtbot.waitUntil(lambda: evaluator.idle)
    yield session, evaluator
    evaluator.close()
    session.deleteLater()


def steps():
    return (set_parameter("slow", "added", float(step)) for step in count(1))


def test_a_slow_drag_shows_previews_and_then_the_full_picture(slow, qtbot):
    session, evaluator = slow
    answers = []
    evaluator.answered.connect(answers.append)
    seen = drag(qtbot, session, evaluator, steps(), lambda so_far: len(so_far.previews) >= 5)
    qtbot.waitUntil(lambda: evaluator.idle)
    last = answers[-1]
    assert last.reduced == 1
    assert last.value.shape == (512, 512)
    scene = Engine(session.library).plan(session.network)
    work = Engine(session.library).work(Policy())
    plain = Engine(session.library).value(scene, "scene.image", work)
    assert np.array_equal(last.value, plain + np.float32(seen.edits))
    previews = [answer for answer in answers if answer.reduced > 1]
    assert {answer.value.shape for answer in previews} <= {(128, 128), (256, 256), (64, 64)}
    generations = [answer.generation for answer in answers]
    assert generations == sorted(generations)
