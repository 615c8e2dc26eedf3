"""What an image viewer asks and is answered: samples, mapping, comparison, keys. No Qt."""

import json

import numpy as np
import pytest

from app.editor.canvas.node_thumbnails import NodeThumbnailQuery
from app.editor.evaluation.queries import Passing
from app.editor.viewers.pixels.grey_levels import grey_levels
from app.editor.viewers.pixels.picture_query import PictureQuery
from core.chain.engine import Engine
from core.errors import ImagechainError
from core.evaluation.policy import Policy
from core.network.file import parse_network
from nodes.library import standard_library
from picture_bench import PictureBench


def share(samples, low, high):
    return (samples.astype(np.longdouble) - low) / (high - low)


@pytest.fixture
def bench():
    return PictureBench()


def test_samples_are_those_of_the_wire_and_not_copied(bench):
    picture = bench.answer(PictureQuery("back.image"))
    assert picture.samples is bench.value("back.image")
    for array in (picture.samples, picture.grey):
        assert not array.flags.writeable
    facts = picture.facts
    assert (facts.rows, facts.columns, facts.unit) == (41, 48, "W/m²/sr")
    assert facts.band_um == (8.0, 12.0)
    assert picture.levels == (float(picture.samples.min()), float(picture.samples.max()))
    assert not picture.logarithmic


def test_percentiles_as_levels(bench):
    picture = bench.answer(PictureQuery("scene.image", levels="percentiles"))
    samples = bench.value("scene.image").astype(float)
    low, high = np.percentile(samples, (0.5, 99.5))
    if low == high:
        low, high = samples.min(), samples.max()
    assert picture.levels == pytest.approx((low, high), rel=1e-12)


def test_levels_that_are_given(bench):
    picture = bench.answer(PictureQuery("back.image", levels=(1.0, 30.0)))
    assert picture.levels == (1.0, 30.0)
    wanted = np.clip(share(picture.samples, 1.0, 30.0) * 255, 0, 255)
    assert np.abs(picture.grey - wanted).max() <= 0.5001


def test_logarithm(bench):
    picture = bench.answer(PictureQuery("back.image", mapping="log"))
    assert picture.samples is bench.value("back.image")
    logarithm = np.log10(np.abs(picture.samples.astype(float)))
    assert picture.levels == pytest.approx((logarithm.min(), logarithm.max()), abs=1e-6)
    assert picture.logarithmic


def test_centred_spectrum_of_a_picture(bench):
    picture = bench.answer(PictureQuery("back.image", mapping="spectrum"))
    samples = bench.value("back.image").astype(float)
    modulus = np.fft.fftshift(np.abs(np.fft.fft2(samples)))
    assert np.allclose(picture.samples, modulus, rtol=1e-4, atol=1e-6 * modulus.max())
    assert picture.samples[41 // 2, 48 // 2] == pytest.approx(samples.sum(), rel=1e-6)
    assert picture.levels[1] == pytest.approx(np.log10(modulus.max()), abs=1e-6)
    assert picture.logarithmic


@pytest.mark.parametrize("port", ["jitter.magnitude", "init.phase", "jitter.mtf"])
def test_planes_have_zero_frequency_in_the_middle(bench, port):
    picture = bench.answer(PictureQuery(port))
    plane = bench.value(port)
    assert (picture.samples == np.fft.fftshift(plane)).all()
    facts, grid = picture.facts, bench.plan.output(port).grid
    assert facts.kind == "plane"
    for axis, frequencies in ((facts.across, grid.xi()), (facts.along, grid.eta())):
        ordered = np.fft.fftshift(frequencies)
        places = [axis.at(index) for index in range(len(ordered))]
        assert places == pytest.approx(ordered.tolist(), abs=1e-12)
        assert axis.unit == "cyc/mrad"
        assert "cyc/mrad" in axis.title


def test_a_plane_is_its_own_spectrum(bench):
    linear = bench.answer(PictureQuery("jitter.mtf"))
    spectrum = bench.answer(PictureQuery("jitter.mtf", mapping="spectrum"))
    assert (linear.grey == spectrum.grey).all()
    assert not spectrum.logarithmic


def test_pupil(bench):
    picture = bench.answer(PictureQuery("pupil.pupil"))
    assert (picture.facts.rows, picture.facts.columns) == (24, 32)
    assert (picture.samples == bench.value("pupil.pupil")).all()


def test_difference(bench):
    picture = bench.answer(PictureQuery("back.image", "scene.image", "difference"))
    wanted = bench.value("back.image") - bench.value("scene.image")
    assert (picture.samples == wanted).all()
    reach = float(np.abs(wanted).max())
    assert picture.levels == (-reach, reach)
    middle = grey_levels(np.zeros((1, 1), np.float32), *picture.levels)[0, 0]
    assert middle in (127, 128)


def test_wipe_has_the_same_levels_on_both_sides(bench):
    picture = bench.answer(PictureQuery("scene.image", "pixels.image", "wipe"))
    assert picture.other.levels == picture.levels
    assert (picture.other.samples == bench.value("pixels.image")).all()
    assert picture.other.grey.shape == (41, 24)


def test_wipe_of_different_quantities_has_levels_of_their_own(bench):
    picture = bench.answer(PictureQuery("scene.image", "jitter.mtf", "wipe", levels=(3.0, 4.0)))
    mtf = bench.value("jitter.mtf")
    assert picture.levels == (3.0, 4.0)
    assert picture.other.levels == (float(mtf.min()), float(mtf.max()))


@pytest.mark.parametrize(
    ("query", "words"),
    [
        (PictureQuery("init.context"), "init.context is a context"),
        (PictureQuery("nothing.image"), "no node 'nothing'"),
        (PictureQuery("scene.magnitude"), "no output 'magnitude'"),
        (PictureQuery("lonely.image"), "input"),
        (PictureQuery("scene.image", "pixels.image", "difference"), "48 × 41 .* 24 × 41"),
        (PictureQuery("scene.image", "jitter.mtf", "difference"), "a picture .* a plane"),
        (PictureQuery("init.phase", "jitter.mtf", "difference"), "in rad.* in no unit"),
    ],
)
def test_what_cannot_be_shown_says_why(bench, query, words):
    with pytest.raises(ImagechainError, match=words) as caught:
        bench.answer(query)
    assert "\n" not in str(caught.value)


def test_samples_that_are_not_finite_are_told(bench, tmp_path):
    picture = np.ones((8, 9), np.float32)
    picture[3, 4] = np.nan
    np.save(tmp_path / "bad.npy", picture)
    document = {
        "format": "imagechain-network",
        "version": 1,
        "nodes": {"file": {"module": "read_image", "params": {"path": "bad.npy"}}},
        "links": [],
    }
    network = parse_network(json.dumps(document), library=bench.engine.library)
    plan = bench.engine.plan(network, folder=tmp_path)
    with pytest.raises(ImagechainError, match="not finite"):
        bench.answer(PictureQuery("file.image"), plan)


def test_the_key_tells_whether_the_picture_would_change(bench):
    query = PictureQuery("scene.image")
    key = query.key(bench.plan)
    assert query.key(bench.changed("jitter", "sigma_mrad", 0.1)) == key
    assert query.key(bench.changed("scene", "temperature_K", 250.0)) != key
    assert query.key(bench.changed("scene", "fov_x_deg", 4.0)) != key
    assert PictureQuery("scene.image", mapping="log").key(bench.plan) != key
    both = PictureQuery("scene.image", "back.image", "wipe")
    assert both.key(bench.changed("jitter", "sigma_mrad", 0.1)) != both.key(bench.plan)
    alone = PictureQuery("scene.image", "back.image", "alone")
    assert alone.key(bench.changed("jitter", "sigma_mrad", 0.1)) == alone.key(bench.plan)


@pytest.mark.parametrize(
    ("params", "grey"),
    [
        ({"offset_dn": 300.0}, 255),  # every number is the last of eight bits
        ({"offset_dn": -300.0}, 0),
        ({"offset_dn": 100.0}, 128),
        ({"offset_dn": 255.0, "bits": 0, "gain_e_per_dn": 1e30}, 128),  # no converter: no ends
    ],
)
def test_pictures_clipped_throughout_are_white_or_black(params, grey):
    document = {
        "format": "imagechain-network",
        "version": 1,
        "nodes": {
            "scene": {
                "module": "test_scene",
                "params": {"width": 16, "height": 16, "cut_on_um": 3.0, "cut_off_um": 5.0,
                           "fov_x_deg": 1.0, "fov_y_deg": 1.0},
            },
            "init": {"module": "init_trans", "params": {
                "focal_length_mm": 100.0, "f_number": 2.0,
                "detector_x_um": 20.0, "detector_y_um": 20.0}},
            "fpa": {"module": "focal_plane", "params": {
                "units": "dn", "bits": 8, "gain_e_per_dn": 1e9, **params}},
        },
        "links": [["scene.image", "init.image"], ["scene.image", "fpa.image"],
                  ["init.context", "fpa.context"]],
    }  # fmt: skip
    library = standard_library()
    engine = Engine(library)
    plan = engine.plan(parse_network(json.dumps(document), library=library))
    passing = Passing(engine, plan, engine.work(Policy()), 1)
    for levels in ("extremes", "percentiles"):
        assert (PictureQuery("fpa.image", levels=levels).answer(passing).grey == grey).all()
    assert (NodeThumbnailQuery("fpa").answer(passing).grey == grey).all()
