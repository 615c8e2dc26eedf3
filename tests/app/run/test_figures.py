"""The main figures of a run: on the terminal, in the report, and in the window's strip alike."""

import html
import json
import math
import re

import numpy as np
import pytest

from app.run.evaluation import sensor_node
from command_line import run_here
from core.chain.engine import Engine
from core.records import replace
from linked_network import linked_network
from nodes.library import standard_library


@pytest.fixture(scope="module")
def mwir(tmp_path_factory):
    """The terminal of the MWIR camera, its read-outs, and its picture."""
    folder = tmp_path_factory.mktemp("mwir")
    done = run_here("run", "mwir_camera", "--save", "focal_plane.image=p.npy", folder=folder)
    assert (done.returncode, done.stderr) == (0, "")
    readouts = json.loads((folder / "mwir_camera-output/readouts.json").read_text())
    return done.stdout.splitlines(), readouts, np.load(folder / "p.npy").astype(float)


def line(lines, caption):
    (found,) = [line for line in lines if line.startswith(caption)]
    return found[len(caption) :]


def test_an_engineer_reads_a_dozen_lines(mwir):
    lines, readouts, _ = mwir
    assert lines.index("") <= 13
    camera, merit = readouts["focal_plane"], readouts["merit"]
    assert line(lines, "Well fill").split()[:2] == [f"{camera['well_fill_percent']:.4g}", "%"]
    assert line(lines, "Signal").split()[:2] == [f"{camera['signal_e'] / 1e3:.4g}", "ke-"]
    assert line(lines, "Noise").split()[:2] == [f"{camera['temporal_noise_e']:.4g}", "e-"]
    assert line(lines, "NETD").split()[:2] == [f"{1e3 * camera['netd_K']:.4g}", "mK"]
    ranges = [merit[f"{name}_range_km"] for name in ("detection", "recognition", "identification")]
    told = ", ".join(f"{each:.4g}" for each in ranges)
    assert f"  {told} km  " in line(lines, "Range: detect, recognise, identify")
    count = sum(value is not None for node in readouts.values() for value in node.values())
    assert f"all {count} read-outs: use --all, or see readouts.json" in lines
    assert not any("weighting_worth_percent" in each for each in lines)


def test_the_output_is_that_of_the_picture(mwir):
    lines, _, picture = mwir
    told = ", ".join(f"{each:.4g}" for each in (picture.min(), picture.mean(), picture.max()))
    assert f"  {told} DN  " in line(lines, "Output: minimum, mean, maximum")


def test_the_report_opens_with_the_same_figures_as_a_card(works, tmp_path):
    done = works("run", "mwir_camera", "--report", "r.html")
    lines = done.stdout.splitlines()
    printed = lines[: next(n for n, line in enumerate(lines) if line.startswith("all "))]
    told = [tuple(re.split(" {2,}", row)[:2]) for row in printed]
    page = (tmp_path / "r.html").read_text(encoding="utf-8")
    card = page.index('<table class="card">')
    assert "<h2" not in page[:card]
    body = page[card : page.index("</table>", card)]
    cells = [html.unescape(cell) for cell in re.findall("<td[^>]*>(.*?)</td>", body)]
    assert told == [
        (name, value.strip()) for name, value in zip(cells[::2], cells[1::2], strict=True)
    ]
    assert len(told) == 11


def test_the_mtf_is_the_product_at_the_pixels_nyquist_frequency(works, write, small, tmp_path):
    """Two Gaussians of 0.5 and the jitter's σ; blocks of two halve the Nyquist frequency."""
    works("run", write(small), "--report", "r.json", "--precision", "double")
    figures = json.loads((tmp_path / "r.json").read_text())["figures"]
    (mtf,) = [figure for figure in figures if figure["caption"].startswith("MTF")]
    nodes = small["nodes"]
    sigmas = [
        (nodes["blur"]["params"]["sigma_x_mrad"], nodes["jitter"]["params"]["sigma_mrad"]),
        (nodes["blur"]["params"]["sigma_y_mrad"], nodes["jitter"]["params"]["sigma_mrad"]),
    ]
    places = [0.25 / (1000 * math.radians(3.0) / 48), 0.25 / (1000 * math.radians(2.5) / 40)]
    exact = [
        math.exp(-2 * math.pi**2 * place**2 * sum(sigma**2 for sigma in both))
        for place, both in zip(places, sigmas, strict=True)
    ]
    assert mtf["values"] == pytest.approx(exact, rel=1e-12)
    assert mtf["caption"] == f"MTF at the pixels' Nyquist ({places[0]:.4g} cyc/mrad)"


SENSORS = {
    "scene": ("test_scene", {"width": 8, "height": 8}),
    "camera": ("camera", {"pitch_um": 15, "focal_length_mm": 50, "f_number": 4}),
    "init": ("init_trans", {}),
    "one": ("focal_plane", {}),
    "two": ("focal_plane", {}),
    "pixels": ("combine_pixels", {}),
    "dual": ("dual_gain", {"switch_level": 1.0}),
}
WIRES = [("scene.image", "camera.image"), ("camera.image", "init.image")]
WIRES += [("camera.image", f"{name}.image") for name in ("one", "two")]
WIRES += [("init.context", f"{name}.context") for name in ("one", "two")]
TO_DUAL = {"one": [("one.image", "dual.low"), ("two.image", "dual.high")],
           "two": [("one.image", "dual.high"), ("two.image", "dual.low")]}  # fmt: skip


@pytest.mark.parametrize(
    ("left_out", "wires", "marked", "preferred", "expected"),
    [
        (("one", "two", "pixels", "dual"), [], None, None, None),
        (("one", "two", "pixels", "dual"), [], None, "camera", None),
        (("two", "pixels", "dual"), [], None, None, "one"),
        (("pixels", "dual"), [], None, None, None),  # both could be meant
        (("pixels", "dual"), [], None, "two", "two"),
        (("pixels", "dual"), [], None, "camera", None),
        (("pixels", "dual"), [], "one.image", None, "one"),
        (("pixels", "dual"), [], "two.image", None, "two"),
        (("dual",), [("one.image", "pixels.image")], "pixels.image", None, "one"),
        (("dual",), [("two.image", "pixels.image")], "pixels.image", "one", "one"),
        (("dual",), [("two.image", "pixels.image")], "camera.image", None, "two"),  # the last one
        (("pixels",), TO_DUAL["one"], None, None, "two"),
        (("pixels",), TO_DUAL["two"], None, None, "one"),
        (("pixels",), TO_DUAL["two"], None, "two", "one"),  # of the low gain there are none
    ],
)
def test_the_figures_are_those_of_the_sensor_before_the_output(
    left_out, wires, marked, preferred, expected
):
    nodes = {name: node for name, node in SENSORS.items() if name not in left_out}
    gone = {f"{name}.image" for name in left_out}
    links = [link for link in WIRES if link[1].partition(".")[0] not in left_out]
    network = linked_network(nodes, [link for link in links + wires if link[0] not in gone])
    network = replace(network, extra={"final": marked} if marked else {})
    assert sensor_node(Engine(standard_library()).plan(network), preferred) == expected
