"""Every public name of the package's classes, used once with real data.

Properties are read and methods without arguments called; of those with arguments it stands here how
they are called. A new one is found by itself.
"""

import json
from pathlib import Path

import numpy as np
import pytest

import imagechain as ic
from edge_truth import blur_network, gaussian_edge
from nodes.files.formats import read_pixels

EDGE = gaussian_edge(angle_deg=6.0, sigma=(0.6, 0.8), shape=(64, 64), noise=15.0, seed=1)


def chain():
    made = ic.Chain("Mine", seed=7)
    made.add(ic.modules.test_scene(kind="slanted_edge", width=32, height=24), name="scene")
    made.add(ic.modules.init_trans(focal_length_mm=100), name="init")
    made.add(ic.modules.gaussian_mtf(sigma_x_mrad=0.5, sigma_y_mrad=0.3), name="blur")
    made.add(ic.modules.back_transform(), name="back")
    return made


def fitted():
    blurs = {"sigma_x_mrad": 0.05, "sigma_y_mrad": 0.08}
    network = blur_network(blur=("gaussian_mtf", blurs), jitter=("jitter_mtf", {"sigma_mrad": 0.0}))
    Path("camera.json").write_text(json.dumps(network), encoding="utf-8")
    return ic.fit("camera.json", to=EDGE, free="blur.sigma_x_mrad=0.01:0.2")


def refused(method, *values):
    """Whether a picture without bands refuses it."""
    with pytest.raises(ic.ParameterError, match="bands"):
        method(*values)
    return True


MADE = {
    ic.Chain: chain,
    ic.ChainNode: lambda: chain()["blur"],
    ic.Part: lambda: ic.modules.gaussian_mtf(sigma_x_mrad=0.5),
    ic.Result: lambda: chain().run(precision="double"),
    ic.Picture: lambda: chain().run().picture(),
    ic.ReadoutTable: lambda: chain().run().readouts,
    ic.StageCurves: lambda: chain().run().curves(),
    ic.StudyTable: lambda: ic.study(
        chain(), vary={"blur.sigma_x_mrad": [0.1, 0.2]}, figures=["total.mtf_nyquist_x"]
    ),
    ic.MeasuredPictures: lambda: ic.measure(np.stack([EDGE, EDGE[::-1]])),
    ic.FittedChain: fitted,
}
CALLED = {
    ic.Chain: {
        "add": lambda c: c.add(ic.modules.examine_image(), name="look").module == "examine_image",
        "get": lambda c: c.get("blur.sigma_x_mrad") == 0.5,
        "set": lambda c: c.set("blur.sigma_x_mrad", 0.4).get("blur.sigma_x_mrad") == 0.4,
        "reset": lambda c: c.reset("init.focal_length_mm").get("init.focal_length_mm") != 100,
        "with_": lambda c: c.with_({"blur.sigma_x_mrad": 0.1}).get("blur.sigma_x_mrad") == 0.1,
        "link": lambda c: ("init.phase", "back.phase") in c.link("init.phase", "back.phase").links,
        "unlink": lambda c: len(c.unlink("init.phase", "back.phase").links) < len(chain().links),
        "replace_scene": lambda c: c.replace_scene(EDGE).run().image().shape == EDGE.shape,
        "camera": lambda c: c.camera(EDGE.shape)(EDGE).shape == EDGE.shape,
        "remove": lambda c: "back" not in c.remove("back"),
        "rename": lambda c: "end" in c.rename("back", "end"),
        "mark_final": lambda c: c.mark_final("back").final == "back.image",
        "save": lambda c: ic.open(c.save("mine.json")).name == "Mine",
        "part": lambda c: c.part("blur") is not None,
    },
    ic.ChainNode: {"set": lambda n: n.set(sigma_x_mrad=0.2) is None and n.sigma_x_mrad == 0.2},
    ic.Result: {
        "save": lambda r: np.array_equal(read_pixels(r.save("cube.img")), r.image()),
        "report": lambda r: all("Mine" in r.report(x).read_text() for x in ("x.html", "x.json")),
        "value": lambda r: r.value("blur.magnitude").shape == (24, 32),
    },
    ic.Picture: {
        "band": lambda p: refused(p.band, 0),
        "cube": lambda p: refused(p.cube),
        "save": lambda p: np.array_equal(read_pixels(p.save("p.npy")), p.samples),
    },
    ic.ReadoutTable: {
        "get": lambda t: t.get("init")["nyquist_x"] > 0,
        "row": lambda t: t.row("init.nyquist_x").unit == "cyc/mrad",
    },
    ic.StageCurves: {"get": lambda c: c.get("blur")["x"].mtf[0] == 1.0},
    ic.StudyTable: {"get": lambda t: t.get("blur.sigma_x_mrad") == [0.1, 0.2]},
    ic.MeasuredPictures: {
        "save": lambda m: json.loads(m.save("m.json").read_text()) == m.to_dict(),
        "without": lambda m: len(m.without(0).edges) == len(m.edges),
    },
    ic.FittedChain: {"save": lambda f: json.loads(f.save("f.json").read_text()) == f.to_dict()},
}


@pytest.mark.parametrize("kind", MADE, ids=lambda kind: kind.__name__)
def test_every_public_name_works(kind, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = MADE[kind]()
    assert isinstance(made, kind)
    for name in (name for name in dir(kind) if not name.startswith("_")):
        if kind is ic.Chain:
            made = chain()  # most of its methods change it
        if name in CALLED.get(kind, {}):
            assert CALLED[kind][name](made), name
            continue
        value = getattr(made, name)
        if callable(value):
            value()
    assert set(CALLED.get(kind, {})) <= set(dir(kind))
    assert repr(made)


def test_envi_has_its_header_and_a_picture_no_unknown_suffix(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = chain().run()
    result.save("p.img")
    assert "samples = 32" in (tmp_path / "p.img.hdr").read_text()
    for name in ("p.nc", "p.h5", "p.jpg"):
        with pytest.raises(ic.UsageError, match=name):
            result.picture().save(name)
    assert {path.name for path in tmp_path.iterdir()} == {"p.img", "p.img.hdr"}
