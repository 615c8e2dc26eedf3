"""Pictures that were filtered after they were taken: what is said of them."""

import csv
import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as Pillow
from scipy import ndimage

from app.handbook.example_figures import PAGES
from app.measure.measurement_page import measurement_csv, measurement_facts, measurement_page
from app.measure.measurement_text import (
    counted,
    figure_rows,
    in_words,
    refused_lines,
    remarks,
    with_error,
)
from app.measure.measuring import measure_pictures
from app.measure.picture_measurement import PictureFile, file_of, picture_name
from camera_scenes import box, turned
from core.physics.measurement.edge_search import find_edges
from core.physics.measurement.sample_noise import LineNoise
from core.records import replace
from edge_truth import blur_network, gaussian_edge
from oversampled_camera import Camera, half_plane, take
from oversampled_scene import Scene, Shape

SCENE = Scene(
    background=3000,
    shapes=tuple(
        Shape(turned(box(46, 46), angle, middle), level)
        for angle, middle, level in ((11, (40, 42), 9000), (27, (140, 140), 7000))
    ),
)


@pytest.fixture(scope="module")
def taken():
    camera = Camera(cutoff=1.2, jitter=0.3, gain_e_per_dn=50, read_e=30)
    return take(SCENE, camera, rows=192, columns=200, seed=1).picture


def measured(picture):
    return measure_pictures([PictureFile.of("one", [picture])])


def test_a_picture_as_it_is_has_nothing_against_it(taken):
    plain = measured(taken)
    assert plain.x is not None
    # Of the mean level's electrons, and the read noise.
    assert plain.noise.sigma == pytest.approx(np.sqrt(50 * taken.mean() + 30**2) / 50, rel=0.03)
    assert not any("sharpened" in line for line in remarks(plain))


@pytest.mark.parametrize("amount", [0.4, 2.0])
def test_noise_of_a_sharpened_picture_is_withheld(taken, amount):
    picture = taken + amount * (taken - ndimage.gaussian_filter(taken, 1.0))
    sharpened = measured(picture)
    assert sharpened.noise is None
    assert "sharpened" in sharpened.noise_reason


def test_an_mtf_above_one_is_called_that_of_a_sharpened_picture(taken):
    picture = taken + 2.0 * (taken - ndimage.gaussian_filter(taken, 1.0))
    lines = remarks(measured(picture))
    assert any(
        line.startswith("warning: the horizontal MTF exceeds 1. The picture was") for line in lines
    )


def test_one_edge_that_overshoots_is_no_measurement():
    camera = Camera(cutoff=1.2, jitter=0.3, gain_e_per_dn=50, read_e=30)
    picture = take(half_plane(9.0, (60, 50), 3000, 9000), camera, rows=100, columns=120).picture
    assert measured(picture).x.edges == 1
    sharpened = measured(picture + 2.0 * (picture - ndimage.gaussian_filter(picture, 1.0)))
    assert sharpened.x is None
    assert sharpened.reason_x.startswith(
        "the only edge that would give this MTF overshoots (its MTF reaches 1."
    )
    assert not any(name.endswith("_x") for name, *_ in figure_rows(sharpened))


@pytest.mark.parametrize("colour", ["green", "red"])
def test_a_mosaic_of_filters_that_was_filled_in_is_measured_with_a_warning(taken, colour):
    kept, weights = np.zeros_like(taken), [[1, 2, 1], [2, 4, 2], [1, 2, 1]]
    kept[::2, ::2] = 1.0
    if colour == "green":
        kept[1::2, 1::2], weights = 1.0, [[0, 1, 0], [1, 4, 1], [0, 1, 0]]
    filled = ndimage.convolve(taken * kept, np.array(weights) / 4.0)
    result = measured(filled)
    assert 0.1 < result.x.mtf50 < measured(taken).x.mtf50
    assert result.noise is None
    assert "interpolated" in result.noise_reason
    assert any(line.startswith("warning: one: interpolated: ") for line in remarks(result))
    # A fit of the camera's own blur is not for such a picture.
    seen = find_edges(picture=filled)
    assert not any(edge.used for edge in seen)
    assert any(edge.why_not.startswith("interpolated: ") for edge in seen)


def test_one_edge_has_one_error():
    camera = Camera(cutoff=1.2, jitter=0.3, gain_e_per_dn=50, read_e=30)
    picture = take(half_plane(9.0, (60, 50), 3000, 9000), camera, rows=100, columns=120).picture
    result = measured(picture)
    (edge,) = [edge for edge in result.edges if edge.used]
    assert edge.mtf50_sigma == pytest.approx(result.x.mtf50_sigma, rel=1e-9)
    text = with_error(result.x.mtf50, result.x.mtf50_sigma)
    assert measurement_page(result).count(text) == 2
    (written,) = [one for one in measurement_facts(result)["edges"] if one["used"]]
    assert written["sigma"] == pytest.approx(result.x.mtf50_sigma, rel=1e-9)


# --- pictures with loss ---

FREE = ("--free", "blur.sigma_x_mrad")


@pytest.fixture
def picture(tmp_path):
    """An edge of the chain's own blur, in 8 bits, and the chain."""
    network = blur_network(blur=("gaussian_mtf", {"sigma_x_mrad": 0.06, "sigma_y_mrad": 0.05}))
    (tmp_path / "net.json").write_text(json.dumps(network), encoding="utf-8")
    edge = gaussian_edge(
        angle_deg=6.0, sigma=(0.6, 0.5), shape=(64, 64), levels=(50, 200), noise=1.5, seed=5
    )
    return Pillow.fromarray(np.rint(edge).astype(np.uint8))


# Of the best quality: no border of a block shows in the samples.
@pytest.mark.parametrize(
    ("name", "how"), [("a.jpg", {"quality": 100}), ("a.jp2", {"irreversible": True})]
)
def test_no_figure_comes_of_a_file_with_loss(fails, works, tmp_path, picture, name, how):
    picture.save(tmp_path / name, **how)
    works("measure", name, "--json", "m.json")
    facts = json.loads((tmp_path / "m.json").read_text("utf-8"))
    assert set(facts["mtf"]["x"]) == set(facts["mtf"]["y"]) == set(facts["noise"]) == {"reason"}
    assert "lossy compression" in facts["mtf"]["x"]["reason"]
    assert "lossy compression" in facts["noise"]["reason"]
    assert not any(one["used"] for one in facts["edges"])
    assert facts["warnings"] == [line for line in facts["warnings"] if "without loss" in line] != []
    line = fails("fit", "net.json", "--to", name, *FREE, "--json", "f.json")
    assert line.startswith(f"imagechain: {name}: the file uses lossy compression")
    assert not (tmp_path / "f.json").exists()


@pytest.mark.parametrize(("name", "how"), [("a.png", {}), ("a.jp2", {"irreversible": False})])
def test_what_keeps_every_sample_is_measured(works, tmp_path, picture, name, how):
    picture.save(tmp_path / name, **how)
    works("measure", name, "--json", "m.json")
    facts = json.loads((tmp_path / "m.json").read_text("utf-8"))
    assert facts["mtf"]["x"]["mtf50"] > 0.0
    # So few samples do not give the noise to the 3 % that are asked for; why says what they give.
    assert "1.5" in facts["noise"]["reason"]


# --- edges that are refused ---

SIZE = (96, 96)


def edge(angle_deg=6.0, **how):
    how = {"sigma": (0.6, 0.6), "shape": SIZE, "levels": (50.0, 200.0), "noise": 1.0, **how}
    return gaussian_edge(angle_deg=angle_deg, seed=3, **how)


def two_edges():
    """A dark bar, seven samples wide."""
    left, right = (edge(middle=(48.0 + away, 48.0), noise=0.0) for away in (-3.5, 3.5))
    return 200.0 - left + right + np.random.default_rng(2).standard_normal(SIZE)


def interlaced():
    picture = edge()
    picture[1::2] = np.roll(picture[1::2], 2, axis=1)
    return picture[:, 4:]


def uneven():
    """One side is striped, by half of the contrast."""
    stripes = 37.0 * np.sin(np.arange(SIZE[0]) / 3.0)[:, np.newaxis]
    return edge() + stripes * (edge(noise=0.0) - 50.0) / 150.0


@pytest.mark.parametrize(
    ("picture", "words"),
    [
        (np.clip(edge(), 60.0, 190.0), "clipped"),
        (edge(levels=(50.0, 62.0), noise=3.0, shape=(24, 96)), "too little contrast"),
        (edge(0.0), "not slanted enough"),
        (edge(0.5, middle=(92.5, 48.0)), "too close to the frame's border"),
        (two_edges(), "another edge too close"),
        (interlaced(), "interlaced"),
        (uneven(), "brightness or contrast varies along the edge"),
        (edge(sigma=(5.0, 5.0)), "the edge spread is wider than the clear area around the edge"),
    ],
)
def test_the_clearest_edge_is_refused(picture, words):
    seen = find_edges(picture=picture)
    assert seen
    assert not seen[0].used
    assert seen[0].why_not.partition(":")[0] == words
    assert words in (PAGES / "edge_pictures.md").read_text(encoding="utf-8")


def test_what_helps_is_named_where_no_edge_is_used():
    def lines(picture):
        return refused_lines(measured(picture))

    advice = "for advice, run imagechain handbook edge_pictures"
    told = ["1 edge not used: not slanted enough", advice]
    assert lines(edge(0.0)) == told
    both = np.concatenate([edge(0.0), edge()], axis=1)
    assert lines(both)
    assert told[1] not in lines(both)


# --- figures in words ---


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (0.187208, 0.000277855, "0.18721 ± 0.00028"),
        (1e-10, 0.0034, "0.0000 ± 0.0034"),
        (12345.6, 480.0, "12350 ± 480"),
        (3.2e-9, 1.1e-10, "3.2e-09 ± 1.1e-10"),
        (0.12345, None, "0.1235"),
        (None, 1.0, "–"),
    ],
)
def test_a_figure_has_the_digits_that_its_error_leaves(value, error, text):
    assert with_error(value, error) == text


# --- figures and remarks, in words ---


@pytest.fixture(scope="module")
def plain(taken):
    """A measurement with edges in both directions, and its pixels' sizes given."""
    sizes = {"interval_x_mrad": 0.2, "interval_y_mrad": 0.4, "pitch_um": 12.5}
    return replace(measured(taken), **sizes, unit="DN")


@given(st.floats(-1e5, 1e5), st.floats(1e-5, 1e4))
def test_a_figure_and_its_error_end_at_the_same_digit(value, error):
    said, of = with_error(value, error).split(" ± ")
    last = 10.0 ** (math.floor(math.log10(float(f"{error:.2g}"))) - 1)
    assert float(of) == pytest.approx(error, abs=0.5001 * last, rel=1e-9)
    assert float(said) == pytest.approx(value, abs=0.5001 * last)
    assert (
        len(said.partition(".")[2]) == len(of.partition(".")[2]) == max(0, -round(np.log10(last)))
    )


def test_figures_without_an_error_and_of_extreme_errors():
    assert with_error(None, 0.1) == "–"
    for error in (None, 0.0, math.nan, math.inf):
        assert with_error(0.123456, error) == "0.1235"
    assert with_error(1.2345678, 1.234e-7) == "1.23 ± 1.2e-07"
    assert with_error(1.2345678, 1.234e-5) == "1.234568 ± 0.000012"
    assert with_error(1.2e9, 1.234e8) == "1.2e+09 ± 1.2e+08"


def test_every_row_states_the_figure_of_the_measurement(plain):
    rows = {(name, unit): text for name, text, unit, _ in figure_rows(plain)}

    def near(name, unit, value, error):
        said, of = map(float, rows.pop((name, unit)).split(" ± "))
        assert said == pytest.approx(value, abs=0.1 * error)
        assert of == pytest.approx(error, rel=0.06)

    for axis, curve, interval in (("x", plain.x, 0.2), ("y", plain.y, 0.4)):
        for unit, size in (("cyc/sample", 1.0), ("cyc/mrad", interval), ("cyc/mm", 0.0125)):
            near(f"mtf50_{axis}", unit, curve.mtf50 / size, curve.mtf50_sigma / size)
        (half,) = np.flatnonzero(curve.frequency == 0.5)
        near(f"mtf_nyquist_{axis}", "", curve.mtf[half], curve.sigma[half])
    noise = plain.noise
    near("sigma", "DN", noise.sigma, noise.sigma_error)
    for name, unit, value, error in (
        ("gain", "e-/DN", noise.gain_e_per_dn, noise.gain_error),
        ("read_noise", "DN", noise.read_noise_dn, noise.read_noise_error),
    ):
        assert ((name, unit) in rows) == (value is not None)
        if value is not None:
            near(name, unit, value, error)
    assert int(rows.pop(("edges", ""))) == sum(edge.used for edge in plain.edges)
    assert rows.keys() <= {("row_sigma", "DN"), ("column_sigma", "DN")}
    bare = figure_rows(replace(plain, interval_x_mrad=None, pitch_um=None))
    assert [unit for name, _, unit, _ in bare if name == "mtf50_x"] == ["cyc/sample"]
    assert [unit for name, _, unit, _ in bare if name == "mtf50_y"] == ["cyc/sample", "cyc/mrad"]
    assert not any(
        name.startswith("mtf50") for name, *_ in figure_rows(replace(plain, x=None, y=None))
    )
    many = replace(plain.noise, rows=LineNoise(1.234**2, 0.1), columns=LineNoise(0.2, 0.1),
                   gain_e_per_dn=None, read_noise_dn=2.0, read_noise_error=0.1,
                   offset_dn=64.0)  # fmt: skip
    found = {row[0]: row[1:] for row in figure_rows(replace(plain, noise=many, unit=""))}
    assert found["row_sigma"] == ("1.23", "", "row noise")
    assert found["read_noise"] == ("2.00 ± 0.10", "DN", "noise at the dark level of 64")
    assert not {"column_sigma", "gain"} & found.keys()


ABOVE = "warning: the horizontal MTF exceeds 1."
FEW = "warning: only {} with a normal within 30° of the horizontal can be used."
SCATTER = "warning: the horizontal MTFs of the edges scatter by 1.6 times"
PHOTONS = "to get gain and read noise, give"


@pytest.mark.parametrize(
    ("of_x", "of_noise", "of_all", "begins"),
    [
        ({"scatter": 1.5, "edges": 3}, {}, {}, ""),
        ({"scatter": 1.6}, {}, {}, SCATTER),
        ({"edges": 1}, {}, {}, FEW.format("one edge")),
        ({"edges": 2}, {}, {}, FEW.format("2 edges")),
        ({"mtf50": None}, {}, {}, "no horizontal MTF50: the MTF does not fall to one half"),
        ({"mtf": np.full(65, 1.03), "sigma": np.full(65, 0.009)}, {}, {}, ABOVE),
        ({"mtf": np.full(65, 1.03), "sigma": np.full(65, 0.011)}, {}, {}, ""),  # within its error
        ({"mtf": np.full(65, 1.019), "sigma": np.zeros(65)}, {}, {}, ""),
        ({}, {"gain_e_per_dn": None}, {}, PHOTONS),
        ({}, {"read_noise_dn": None}, {}, PHOTONS),
        ({}, {"remarks": ("one remark",)}, {}, "one remark"),
        (
            {},
            {"gain_e_per_dn": None, "gain_reason": "one level"},
            {},
            f"no gain: one level\n{PHOTONS}",
        ),
        ({}, {}, {"x": None, "reason_x": "no edges"}, "no horizontal MTF: no edges"),
        ({}, {}, {"noise": None, "noise_reason": "no flat area"}, "no noise: no flat area"),
        ({}, {}, {"warnings": ("one picture is dark",)}, "warning: one picture is dark"),
        ({}, {}, {"frames_reason": "they move", "two": True}, "temporal noise not measured: they"),
    ],
)
def test_each_remark_has_its_own_reason(plain, of_x, of_noise, of_all, begins):
    usual = {"edges": 3, "scatter": 1.0, "mtf": np.ones(65), "sigma": np.zeros(65)}
    known = {"gain_e_per_dn": 50.0, "read_noise_dn": 1.0, "remarks": (),
             "gain_reason": "", "read_noise_reason": ""}  # fmt: skip
    two = of_all.get("two", False)
    sound = replace(
        plain,
        x=replace(plain.x, **usual | of_x),
        y=replace(plain.y, **usual),
        noise=replace(plain.noise, **known | of_noise),
        edges=plain.edges * 9,
        files=plain.files * (2 if two else 1),
    )
    lines = remarks(replace(sound, **{name: v for name, v in of_all.items() if name != "two"}))
    wanted = begins.splitlines()
    assert len(lines) == len(wanted)
    assert all(map(str.startswith, lines, wanted))


def test_reasons_are_counted_without_their_figures_the_most_frequent_first():
    reasons = ["short: 3", "blunt: 1", "short: 4", "bent", "dark: 2", "short: 9", "blunt: 7"]
    assert counted(reasons) == [("short", 3), ("blunt", 2), ("bent", 1), ("dark", 1)]
    assert in_words(reasons) == "short (3), blunt (2), bent (1), other reasons (1)"
    assert in_words(reasons[:2]) == "short (1), blunt (1)"


def test_pictures_are_numbered_through_files_and_named_by_file_and_frame():
    frames = np.zeros((3, 4, 5))
    files = [PictureFile.of("one", frames[:1]), PictureFile.of("more", list(frames))]
    names = ["one", "more, frame 0", "more, frame 1", "more, frame 2"]
    assert [picture_name(files, number) for number in range(4)] == names
    assert [file_of(files, number)[1] for number in range(4)] == [0, 0, 1, 2]


def test_files_hold_the_curves_at_their_frequencies_in_each_unit(plain):
    falling = np.linspace(2.5, -0.5, 65)  # a table of MTFs ends at 0 and 2
    sharp = replace(plain, x=replace(plain.x, mtf=falling))
    heads, *rows = csv.reader(measurement_csv(sharp).splitlines())
    assert heads == ["frequency (cyc/pixel)", "mtf_x", "mtf_y"]
    found = np.array(rows, float).T
    expected = [plain.x.frequency, np.clip(falling, 0, 2), np.clip(plain.y.mtf, 0, 2)]
    np.testing.assert_array_equal(found, expected)
    (alone, *_) = csv.reader(measurement_csv(replace(plain, x=None)).splitlines())
    assert alone == ["frequency (cyc/pixel)", "mtf_y"]
    facts = measurement_facts(plain)
    for name, curve, interval in (("x", plain.x, 0.2), ("y", plain.y, 0.4)):
        told = facts["mtf"][name]
        for unit, size in (("sample", 1.0), ("mrad", interval), ("mm", 0.0125)):
            assert told[f"frequency_cyc_per_{unit}"] == pytest.approx(curve.frequency / size)
        for key in ("mtf", "sigma", "mtf50", "mtf50_sigma", "edges", "scatter"):
            assert np.all(told[key] == getattr(curve, key))
    assert facts["noise"]["sigma"] == plain.noise.sigma
    assert [edge["used"] for edge in facts["edges"]] == [edge.used for edge in plain.edges]
