"""A chain planned once for many frames: each has the bits of a run on that scene."""

import gc
import pickle
import tracemalloc
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import imagechain as ic

NETWORKS = {"kodak_kir310": (32, 48), "satellite_tdi": (48, 33), "pushbroom_banding": (40, 40)}


def frames_of(shape, count=3, dtype=np.float32):
    random = np.random.default_rng(7)
    if dtype == np.uint8:
        return [random.integers(0, 200, shape, np.uint8) for _ in range(count)]
    return [(random.random(shape) * (5 + k)).astype(dtype) for k in range(count)]


def ran(chain, frame, port=None, *, scene=None, **how):
    """The picture of a run on a chain with that scene."""
    other = chain.copy().replace_scene(frame, **(scene or {}))
    ports = [port or other.final]
    return other.run(outputs=ports, **how).value(ports[0])


@pytest.mark.parametrize(("name", "shape"), NETWORKS.items())
def test_a_frame_has_the_bits_of_a_run(name, shape):
    chain = ic.open(name)
    camera = chain.camera(shape)
    for seed, frame in zip((None, 5, 6), frames_of(shape), strict=True):
        picture = camera(frame, seed=seed)
        np.testing.assert_array_equal(picture, ran(chain, frame, seed=seed))
        assert not picture.flags.writeable
    with pytest.raises(ic.NetworkError, match="has no output 'picture'"):
        chain.camera(shape, outputs="scene.picture")


@pytest.mark.parametrize("dtype", [np.int16, "colour", "uniform"])
def test_frames_of_any_kind(dtype):
    chain = ic.open("mwir_camera")
    camera = chain.camera((24, 30), precision="double", outputs="back.image")
    kind = dtype if isinstance(dtype, type) else np.uint8 if dtype == "colour" else np.float32
    for frame in frames_of((24, 30, 3) if dtype == "colour" else (24, 30), dtype=kind):
        given = np.full_like(frame, 3.1) if dtype == "uniform" else frame
        expected = ran(chain, given, "back.image", precision="double")
        np.testing.assert_array_equal(camera(given), expected)


def test_several_outputs_in_a_unit_with_other_arrays_beside():
    chain = ic.open("mwir_camera")
    outputs = ["back.image", "focal_plane.image", "detector.magnitude"]
    camera = chain.camera([16, 20], outputs=outputs, unit="K", fov_deg=(4.0, 3.2))
    for frame in frames_of((16, 20)):
        made = camera(290 + frame)
        assert list(made) == outputs
        for port, values in made.items():
            scene = {"unit": "K", "fov_deg": (4.0, 3.2)}
            np.testing.assert_array_equal(values, ran(chain, 290 + frame, port, scene=scene))
    assert repr(camera).startswith("<Camera: frames of 16 × 20 to back.image, ")


def test_frames_of_a_sequence_share_their_fixed_patterns():
    chain = ic.open("mwir_camera")
    camera = chain.camera((20, 24))
    frame = frames_of((20, 24))[0]
    whole = chain.with_().replace_scene(frame).run(frames=3, outputs=[chain.final])
    for number, expected in enumerate(whole.image()):
        np.testing.assert_array_equal(camera(frame, number=number), expected)


def test_a_camera_serves_threads_and_goes_to_other_processes():
    chain = ic.open("mwir_camera")
    camera = chain.camera((20, 24))
    frames = frames_of((20, 24), 8)
    with ThreadPoolExecutor(4) as pool:
        made = list(pool.map(camera, frames))
    sent = pickle.loads(pickle.dumps(camera))
    for frame, picture in zip(frames, made, strict=True):
        np.testing.assert_array_equal(picture, sent(frame))
        assert picture.tobytes() == ran(chain, frame).tobytes()


def test_frames_leave_nothing_behind():
    chain = ic.open("mwir_camera").set({"camera.pixels_x": 128, "camera.pixels_y": 128})
    camera = chain.camera((128, 128), threads=1)
    frames = frames_of((128, 128), 4)

    def many(first, count):
        tracemalloc.reset_peak()
        for k in range(first, first + count):
            camera(frames[k % 4], seed=k // 2)
            gc.collect()
        return tracemalloc.get_traced_memory()

    many(0, 4)
    tracemalloc.start()
    try:
        _, peak = many(4, 6)
        left, later_peak = many(10, 12)
    finally:
        tracemalloc.stop()
    assert later_peak < 1.05 * peak
    assert left < 20 * frames[0].nbytes


def test_what_a_camera_refuses():
    chain = ic.open("mwir_camera")
    camera = chain.camera((20, 24))
    good = frames_of((20, 24))[0]
    bad = good.copy()
    bad[3, 4] = np.nan
    refused = (
        (
            lambda: camera(good.T),
            "the frame has 24 × 20 samples: the camera takes frames of 20 × 24",
        ),
        (lambda: camera(bad), "the frame: 1 sample is not finite"),
        (lambda: camera(good, seed=-1), "seed = -1 is not allowed"),
        (lambda: chain.camera(20), "size = 20 is not allowed: must be two whole numbers"),
        (lambda: chain.camera((10**6, 10**6)), "size = (1000000, 1000000): the pictures are too"),
        (lambda: chain.camera((20, 24), fov_deg=5), "fov_deg = 5 is not allowed: must be two"),
        (lambda: chain.camera((20, 24), band_um=(3,)), "band_um = (3,) is not allowed: must be"),
        (lambda: chain.camera((20, 24), range_m="5"), "range_m = '5' is not allowed: must be a n"),
        (lambda: chain.camera((20, 24), unit=None), "unit = None is not allowed: must be text"),
        (lambda: chain.camera((20, 24), outputs=[]), "outputs = [] is not allowed"),
        (lambda: chain.camera((20, 24), outputs="no.image"), "the network has no node 'no'"),
    )
    for attempt, message in refused:
        with pytest.raises(ic.ImagechainError) as caught:
            attempt()
        assert str(caught.value).startswith(message)
        assert "\n" not in str(caught.value)
    np.testing.assert_array_equal(camera(good), ran(chain, good))


@pytest.mark.parametrize(
    ("usable", "fits"), [(None, True), (4 * 32 * 48, True), (4 * 32 * 48 - 1, False)]
)
def test_a_picture_in_single_precision_fits_into_memory_or_is_refused(monkeypatch, usable, fits):
    """None: of some systems no limit is known."""
    monkeypatch.setattr("imagechain.building.camera.usable_bytes", lambda: usable)
    chain = ic.open("kodak_kir310")
    if fits:
        assert chain.camera((32, 48)) is not None
    else:
        with pytest.raises(ic.UsageError, match=r"size = \(32, 48\): the pictures are too large"):
            chain.camera((32, 48))
