"""Thumbnails below the nodes: what comes out, true to it, and gone at a key."""

import numpy as np
import pytest

from app.editor.canvas.node_thumbnails import SmallCurve, SmallPicture
from core.editing.operations import move_nodes, remove_nodes, set_parameter
from core.evaluation.work import Policy
from window_hands import show_small


@pytest.fixture
def kodak(window, idle, qtbot):
    show_small(window, "kodak_kir310")
    idle(window)
    qtbot.waitUntil(lambda: "frame_grabber" in thumbnails(window) and window.evaluator.idle)
    window.canvas.setFocus()
    return window


def thumbnails(window):
    return window.canvas.thumbnails.items


def full(window, port):
    """The samples that the viewer gets."""
    plan, runner = window.evaluator.plan, window.evaluator._runner
    return np.asarray(runner._engine.value(plan, port, runner._engine.work(Policy())))


def test_pictures_and_curves_stand_below_what_gives_them(kodak):
    items = thumbnails(kodak)
    pictures = {name for name, item in items.items() if isinstance(item.small, SmallPicture)}
    curves = {name for name, item in items.items() if isinstance(item.small, SmallCurve)}
    assert pictures == {
        *("scene", "photons", "pupil", "back", "pixels", "electronics", "frame_grabber")
    }
    assert curves == {"optics", "aberration", "detector", "charge", "charge_phase"}
    for name, item in items.items():
        node = kodak.canvas.content.nodes[name].frame()
        assert item.frame().top() >= node.bottom()
        assert item.frame().left() >= node.left() - 0.5
        assert item.frame().right() <= node.right() + 0.5
    # A picture is that of the node: by block means of its own, the order of light and dark.
    small = items["pixels"].small.grey.astype(float)
    samples = full(kodak, "pixels.image")
    rows, columns = small.shape
    block = samples.shape[0] // rows, samples.shape[1] // columns
    trimmed = samples[: rows * block[0], : columns * block[1]]
    means = trimmed.reshape(rows, block[0], columns, block[1]).mean(axis=(1, 3))
    assert np.corrcoef(means.ravel(), small.ravel())[0, 1] > 0.95
    # A curve is the node's MTF: a Gaussian's logarithm falls as the square of the frequency.
    small = items["aberration"].small
    expected = np.log(small.values[-1]) * np.linspace(0, 1, len(small.values)) ** 2
    np.testing.assert_allclose(np.log(small.values), expected, atol=1e-3)
    assert 0 < small.values[-1] < 1


def test_they_follow_edits_moves_and_removals(kodak, idle, qtbot):
    before = thumbnails(kodak)["aberration"].small.values[-1]
    sigma = kodak.session.network.nodes["aberration"].params["sigma_x_mrad"]
    kodak.session.do(set_parameter("aberration", "sigma_x_mrad", 3 * sigma))
    qtbot.waitUntil(lambda: thumbnails(kodak)["aberration"].small.values[-1] < before - 1e-3)
    # A Gaussian three times as wide: its logarithm at Nyquist is nine times as large.
    after = thumbnails(kodak)["aberration"].small.values[-1]
    assert np.log(after) == pytest.approx(9 * np.log(before), rel=1e-6)
    kodak.session.do(move_nodes({"scene": (-700.0, 300.0)}))
    assert thumbnails(kodak)["scene"].frame().left() >= -700.5
    assert thumbnails(kodak)["scene"].frame().right() <= -700 + 200.5
    kodak.session.do(remove_nodes(("slices", "photons")))
    assert "photons" not in thumbnails(kodak)
    kodak.session.undo()
    qtbot.waitUntil(lambda: "photons" in thumbnails(kodak))
