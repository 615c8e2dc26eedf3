"""``imagechain study`` as a person runs it: rows, reasons, files, and faults in one line."""

import json
import math

import numpy as np
import pytest

from app.run.shipped import find_network, shipped_networks
from app.study.study_request import run_study
from core.network.file import load_network
from nodes.library import standard_library
from tradeoff_network import DOCUMENT, mtf

LIBRARY = standard_library()
SIGMA = "--vary=blur.sigma_x_mrad=0:1:3"
D_STAR = "--vary=electronics.d_star=1e10,1e11"
MTF, NER = "--figure=total.mtf_nyquist_x", "--figure=electronics.ner"
MTF_HEAD, NER_HEAD = "total.mtf_nyquist_x", "electronics.ner (W/m²/sr)"


@pytest.fixture
def study(imagechain):
    return lambda *words: imagechain("study", *words, "--jobs", "1")


def test_a_row_for_each_point(sensor, study, rows_of, tmp_path):
    done = study(sensor, SIGMA, D_STAR, MTF, NER, "--output", "a.csv")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("6 points in ")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.csv", sensor]
    rows = rows_of("a.csv")
    assert [row["point"] for row in rows] == list("123456")
    assert [float(row["blur.sigma_x_mrad (mrad)"]) for row in rows] == [0, 0, 0.5, 0.5, 1, 1]
    # NEP = √(A·Δf)/D*, NER = NEP·G#/A, G# of F/2 (1 + 4·F²)/π, written out.
    area_cm2 = 30e-4**2
    for row in rows:
        d_star = float(row["electronics.d_star (cm √Hz/W)"])
        ner = math.sqrt(area_cm2 * 1e4) / d_star * (1 + 16) / math.pi / area_cm2 * 1e4
        assert float(row[NER_HEAD]) == pytest.approx(ner, rel=1e-12)
        blur = float(row["blur.sigma_x_mrad (mrad)"])
        assert float(row[MTF_HEAD]) == pytest.approx(mtf(blur), rel=1e-12)
        assert row["error"] == ""
    assert len({row["key"] for row in rows}) == 6


def test_failed_points_are_rows_and_the_end_is_2(sensor, study, rows_of, tmp_path):
    words = ["--set", "electronics.region=MWIR", "--set", "electronics.d_star=null"]
    vary = "--vary=electronics.material=PtSi,manual,InSb"
    done = study(sensor, *words, vary, NER, "--output", "a.csv", "--summary", "a.png")
    assert done.returncode == 2
    assert done.stderr.startswith(
        "imagechain: 1 of 3 points failed (see the column error in a.csv); the first is point 2: "
        "electronics: d_star (cm √Hz/W) is empty"
    )
    assert done.stderr.count("\n") == 1
    rows = rows_of("a.csv")
    assert [bool(row[NER_HEAD]) for row in rows] == [True, False, True]
    assert rows[1]["error"] in done.stderr
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


@pytest.fixture
def scenes(tmp_path, imagechain, write):
    """Two pictures that can be read, one that cannot, and a network that reads one of them."""
    folder = tmp_path / "scenes"
    folder.mkdir()
    for number, level in ((2, 3.0), (10, 7.0)):
        np.save(folder / f"s{number}.npy", np.full((16, 16), level, dtype=np.float32))
    (folder / "s3.npy").write_bytes(b"no array")
    np.save(folder / "s4.npy", np.full((16, 16), np.nan, dtype=np.float32))
    document = json.loads(json.dumps(DOCUMENT))
    document["nodes"]["scene"] = {
        "module": "read_image",
        "params": {"path": "none.npy", "fov_x_deg": 3.0, "fov_y_deg": 2.5},
    }
    return write(document, "over.json")


def test_over_pictures_of_which_some_cannot_be_read(scenes, study, rows_of, tmp_path):
    over = ["--over", "scene.path=scenes/s*.npy", "--figure=electronics.snr"]
    save = ["--save", "back.image=out/{scene}_{point}.npy"]
    done = study(scenes, *over, *save, "--output", "a.csv", "--summary", "a.html")
    assert done.returncode == 2
    assert "2 of 4 points failed" in done.stderr
    rows = rows_of("a.csv")
    assert [row["scene.path"] for row in rows] == [
        f"scenes/s{number}.npy" for number in (2, 3, 4, 10)
    ]
    assert "s3.npy" in rows[1]["error"]
    assert "not finite" in rows[2]["error"]
    assert rows[2]["electronics.snr"] == ""
    # Of uniform pictures the signal is the level.
    ratio = float(rows[3]["electronics.snr"]) / float(rows[0]["electronics.snr"])
    assert ratio == pytest.approx(7 / 3, rel=1e-6)
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["s10_4.npy", "s2_1.npy"]
    saved = np.load(tmp_path / "out" / "s10_4.npy")
    assert np.allclose(saved, 7.0, rtol=1e-6)
    assert "2 points failed" in (tmp_path / "a.html").read_text()


def test_tables_of_other_programs(sensor, study, rows_of, tmp_path):
    parquet = pytest.importorskip("pyarrow.parquet")
    xarray = pytest.importorskip("xarray")
    kinds = "--vary=scene.kind=slanted_edge,dormitory"
    for name in ("a.csv", "a.parquet", "a.nc"):
        done = study(sensor, SIGMA, kinds, NER, "--output", name)
        assert (done.returncode, done.stderr) == (0, "")
    rows = rows_of("a.csv")
    table = parquet.read_table(tmp_path / "a.parquet")
    assert table.column(NER_HEAD).to_pylist() == [float(row[NER_HEAD]) for row in rows]
    assert table.column("scene.kind").to_pylist() == [row["scene.kind"] for row in rows]
    assert table.schema.field(NER_HEAD).metadata == {b"unit": "W/m²/sr".encode()}
    with xarray.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as data:
        assert data["electronics.ner"].values.tolist() == table.column(NER_HEAD).to_pylist()
        assert data["electronics.ner"].attrs["units"] == "W/m²/sr"
        assert data["scene.kind"].values.tolist() == [row["scene.kind"] for row in rows]


def test_without_dask_one_line_names_the_extra(monkeypatch, sensor, fails):
    monkeypatch.setattr("app.study.study_rows.has_dask", lambda: False)
    line = fails("study", sensor, SIGMA, NER, "--output", "a.csv", "--scheduler", "tcp://x:1")
    assert "needs the packages dask and distributed: run pip install '.[study]' in" in line


USAGE = {
    "out of range": (["--vary=blur.sigma_x_mrad=-1:1:3"], "blur: sigma_x_mrad = -1.0 mrad"),
    "too many": (
        ["--vary=blur.sigma_x_mrad=0:1:1001", "--vary=jitter.sigma_mrad=0:1:1000"],
        "the study would have 1001000 points; allowed: 1 to 1000000",
    ),
    "points of a grid": ([SIGMA, "--points=3"], "works only with --sample latin"),
    "latin by steps": (
        ["--sample=latin", "--points=3", SIGMA],
        "for random points, write NODE.PARAM=FROM:TO",
    ),
    "list and vary": ([SIGMA, "--sample=list.csv"], "the points come from list.csv"),
    "no list": (["--sample=list.csv"], "cannot read list.csv: No such file"),
    "over the network": ([SIGMA, "--summary=a.csv"], "must end in .png or .html"),
    "one name": ([SIGMA, "--save=back.image=a.npy"], "two files of points 1 and 2"),
    "both": ([SIGMA, "--jobs=2", "--scheduler=tcp://x:1"], "cannot be used together"),
}


@pytest.mark.parametrize(("words", "why"), USAGE.values(), ids=USAGE.keys())
def test_usage(words, why, sensor, fails):
    output = [] if any(word.startswith("--output") for word in words) else ["--output=o.csv"]
    assert why in fails("study", sensor, *words, *output)


@pytest.mark.thorough(but=4, always=("mwir_camera", "dirsig_cube"))
@pytest.mark.parametrize("name", shipped_networks())
def test_the_default_figures_of_a_shipped_network_are_numbers(name):
    """A text, such as what photons are counted by, and the NETD of a sunlit scene are left out."""
    place = find_network(name)
    network = load_network(place.path, library=LIBRARY)
    for node in network.nodes.values():
        if node.module == "test_scene":
            network = network.with_parameter(node.id, "width", 256)
            network = network.with_parameter(node.id, "height", 256)
        if node.module == "camera_geometry":  # which sees past so small a scene
            network = network.with_parameter(node.id, "outside", "fill")
    number, value = next(
        (f"{node.id}.{name}", value)
        for node in network.nodes.values()
        for name, value in node.params.items()
        if isinstance(value, float) and value > 0 and not name.startswith(("fov", "cut"))
    )
    vary = {number: [value, 1.02 * value]}
    result = run_study(network, jobs=1, vary=vary, folder=place.folder)
    assert [row.error for row in result.rows] == ["", ""]
    names = {figure.text for figure in result.study.figures}
    figures = [column.values for column in result.columns() if column.name in names]
    assert figures
    assert all(isinstance(value, float) for values in figures for value in values)
