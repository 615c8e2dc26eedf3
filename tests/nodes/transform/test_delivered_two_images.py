"""Magnitude of one picture with the phase of another, or with none."""

from __future__ import annotations

import numpy as np
import pytest

from analytic_stages import INTERVAL_X, INTERVAL_Y, SENSOR, STAGES, expected_h
from core.chain.engine import Engine
from core.evaluation.work import Policy
from delivered_chains import LIBRARY, chain_network, fov_deg, scene
from linked_network import linked_network


def two_images(shape_a, shape_b, fov_b=1.0, late=False):
    rows, columns = shape_a
    fovs = {"fov_x_deg": fov_deg(columns, INTERVAL_X), "fov_y_deg": fov_deg(rows, INTERVAL_Y)}
    nodes = {
        "a": ("read_image", {"path": "a.npy"}),
        "b": ("read_image", {"path": "b.npy"}),
        "init a": ("init_trans", {**SENSOR, **fovs}),
        "init b": ("init_trans", {**SENSOR, **{k: v * fov_b for k, v in fovs.items()}}),
        "blur": STAGES["blur"],
        "late": STAGES["late"],
        "back": ("back_transform", {}),
    }
    links = [
        ("a.image", "init a.image"), ("b.image", "init b.image"),
        ("init a.context", "blur.context"), ("init a.magnitude", "blur.magnitude"),
        ("init b.context", "late.context"), ("init b.phase", "late.phase"),
        ("blur.magnitude", "back.magnitude"),
        ("late.phase" if late else "init b.phase", "back.phase"),
    ]  # fmt: skip
    return linked_network(nodes, links)


@pytest.mark.parametrize("size", [(31, 17), (24, 10), (1, 8), (7, 1)], ids=str)
@pytest.mark.parametrize("late", [False, True])
def test_magnitude_of_one_and_phase_of_another(tmp_path, size, late):
    a, b = scene(*size, seed=1), scene(*size, seed=2)
    np.save(tmp_path / "a.npy", a)
    np.save(tmp_path / "b.npy", b)
    engine = Engine(LIBRARY)
    plan = engine.plan(two_images(size, size, late=late), folder=tmp_path)
    found = engine.value(plan, "back.image", engine.work(Policy(precision="double")))
    h = expected_h(("blur", "late") if late else ("blur",), *size)
    spectrum = np.abs(np.fft.fft2(a)) * np.exp(1j * np.angle(np.fft.fft2(b))) * h
    expected = np.fft.ifft2(spectrum)
    assert np.abs(expected.imag).max() <= 1e-12 * np.abs(expected).max()
    assert np.abs(found - expected.real).max() <= 1e-12 * np.abs(expected).max()
    assert abs(found.mean() / a.mean() - 1) <= 1e-13


def test_two_samplings_of_one_size_are_kept_apart(tmp_path):
    """A PTF belongs to the frequencies of its own Init & Trans, whatever it is combined with."""
    picture = scene(16, 12)
    np.save(tmp_path / "a.npy", picture)
    np.save(tmp_path / "b.npy", picture)
    engine = Engine(LIBRARY)
    plan = engine.plan(two_images((16, 12), (16, 12), fov_b=2.0, late=True), folder=tmp_path)
    assert plan.errors() == []
    found = engine.value(plan, "back.image", engine.work(Policy(precision="double")))
    # Packets are one sample apart on either: w = 2πk/N at bin k.
    h = expected_h(("blur", "late"), 16, 12)
    expected = np.fft.ifft2(np.fft.fft2(picture) * h).real
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("size", [(31, 17), (24, 10)], ids=str)
def test_filter_alone_gives_its_impulse_response(tmp_path, size):
    np.save(tmp_path / "in.npy", scene(*size))
    document, _ = chain_network(("pixel", "late"), *size)
    for name in ("pixel", "late"):
        document = document.with_parameter(name, "apply", "filter_only")
    engine = Engine(LIBRARY)
    plan = engine.plan(document, folder=tmp_path)
    found = engine.value(plan, "back.image", engine.work(Policy(precision="double")))
    assert np.abs(np.fft.fft2(found) - expected_h(("pixel", "late"), *size)).max() <= 1e-12
    assert found.sum() == pytest.approx(1, abs=1e-13)
