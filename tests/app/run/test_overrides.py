"""File names typed on a command line, and in Python: relative to the current folder."""

import csv
import json

import numpy as np
import pytest

from linked_network import document_of

PICTURE = {"fov_x_deg": 1, "fov_y_deg": 1, "cut_on_um": 8, "cut_off_um": 12, "unit": "W/m^2/sr/um"}


@pytest.fixture
def lab(tmp_path):
    """A network in a folder of its own; each folder has files of the same names, and others."""
    nodes = {
        "scene": ("read_image", {"path": "at_home.npy", **PICTURE}),
        "written": ("write_image", {"path": "written.npy"}),
    }
    folder = tmp_path / "lab"
    for place, levels in ((tmp_path, {"mine": 1, "other": 2}), (folder, {"mine": 8, "at_home": 9})):
        place.mkdir(exist_ok=True)
        for name, level in levels.items():
            np.save(place / f"{name}.npy", np.full((8, 8), float(level)))
    (folder / "net.json").write_text(json.dumps(document_of(nodes)), encoding="utf-8")
    return folder


def rows(file):
    return list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))


def test_run_takes_them_from_the_current_folder(imagechain, works, lab, tmp_path):
    words = ["run", "lab/net.json", "--output-dir", "out", "--save", "scene.image=saved.npy"]
    assert imagechain(*words).returncode == 0
    assert np.load(tmp_path / "saved.npy").max() == np.load(lab / "written.npy").max() == 9
    works(*words, "--set=scene.path=mine.npy", "--set=written.path=typed.npy")
    assert np.load(tmp_path / "saved.npy").max() == np.load(tmp_path / "typed.npy").max() == 1
    assert np.load(lab / "written.npy").max() == 9
    done = imagechain("run", "dirsig_cube", "--set=scene.path=my.img")
    assert f"{tmp_path}/my.img: no such file" in done.stderr


def test_studies_take_them_from_the_current_folder_and_tables_from_theirs(works, lab, tmp_path):
    words = ["study", "lab/net.json", "--output", "s.csv", "--save", "scene.image=at{point}.npy"]
    works(*words, "--vary", "scene.path=mine.npy,other.npy")
    assert [np.load(tmp_path / f"at{number}.npy").max() for number in (1, 2)] == [1, 2]
    assert [row["scene.path"] for row in rows(tmp_path / "s.csv")] == ["mine.npy", "other.npy"]
    for folder, level in ((tmp_path, 1), (lab, 8)):
        (folder / "list.csv").write_text("scene.path\nmine.npy\n", encoding="utf-8")
        words[3] = f"{level}.csv"
        works(*words, "--sample", folder / "list.csv")
        assert np.load(tmp_path / "at1.npy").max() == level


def test_a_node_is_switched_off_for_a_run(imagechain, works, tmp_path):
    """The picture without noise is that before it; a judge or a macro can be switched off too."""
    save = ("--save", "scene.image=scene.npy", "--save", "noise.image=out.npy", "--output-dir", "o")
    nodes = {
        "scene": ("test_scene", {"width": 24, "height": 16, "fov_x_deg": 1, "fov_y_deg": 1}),
        "noise": ("noise_3d_source", {"sigma_tvh": 0.5}),
        "figures": ("noise_3d", {}),
    }
    (tmp_path / "n.json").write_text(json.dumps(document_of(nodes)), encoding="utf-8")
    assert imagechain("run", "n.json", *save).returncode == 0
    assert np.ptp(np.load(tmp_path / "out.npy") - np.load(tmp_path / "scene.npy")) > 1
    works("run", "n.json", "--disable", "noise", *save)
    np.testing.assert_array_equal(np.load(tmp_path / "out.npy"), np.load(tmp_path / "scene.npy"))
    done = works("run", "n.json", "--disable", "figures", "--output-dir", "o", "--json")
    assert not json.loads(done.stdout)["readouts"].get("figures")
